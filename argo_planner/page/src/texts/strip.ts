import { both } from "./both";

export const strip = both({}, {});
