#include "editor/window/program.h"

int main(int argc, char** argv) {
    return sunfleck::editor::run_program(argc, argv);
}
