// The same program as hosts with habits of their own: VkAllocationCallbacks for instance and device, and a table of
// functions of its own, which the module must use and not the loader's.
#pragma once

// Prints what it finds and returns the number of failures.
int run_own_loader();
