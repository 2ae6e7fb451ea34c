import { both } from "./both";

export const script = both({}, {});
