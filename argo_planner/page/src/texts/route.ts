import { both } from "./both";

export const route = both({}, {});
