// The editor with a technique that is not the module's, for the test that everything of it appears (open_test.cpp).
#include "editor/window/program.h"

#include "tests/techniques/constant_light.h"

int main(int argc, char** argv) {
    sunfleck::gi::add_technique(sunfleck::tests::constant_light());
    return sunfleck::editor::run_program(argc, argv);
}
