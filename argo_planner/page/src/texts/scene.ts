import { both } from "./both";

export const scene = both({}, {});
