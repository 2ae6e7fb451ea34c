import { both } from "./both";

export const run = both({}, {});
