import { both } from "./both";

export const forms = both({}, {});
