// The same program with habits of its own: a projection with near and far planes, forward Z and jitter, depth of 16 or
// 24 bits, normals as halves or RGB10A2 without a geometric one, textured materials; and a frame whose recording is
// refused. Its pictures must be those of the module's own camera.
#pragma once

// Prints what it finds and returns the number of failures.
int run_own_projection();
