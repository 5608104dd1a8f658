// World frame x east, y north, z up; three's is x right, y up, z towards the viewer.
import { Vector3 } from "three";

export const toThree = (x, y, z) => new Vector3(x, z, -y);
