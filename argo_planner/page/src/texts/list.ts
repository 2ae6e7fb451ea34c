import { both } from "./both";

export const list = both({}, {});
