// Two running programs that draw what they are asked for.
#pragma once

#include "editor/gate/child_process.h"
#include "editor/gate/protocol.h"
#include "editor/gate/temporary_folder.h"

namespace sunfleck::gate {

// The two command lines. Both are run under paths of equal length, so that neither has another stack.
struct Programs {
    std::vector<std::string> base, head;
};

// A child that has said hello.
class Program {
public:
    // Runs the command through a link in `folder`; call read_hello next. `side`: "base" or "head".
    static Result<std::unique_ptr<Program>> start(const std::filesystem::path& folder, std::vector<std::string> command,
                                                  const char* side, const Patience& patience);
    Status read_hello();
    const Hello& hello() const { return hello_; }

    Status request(const DrawFrames& frames);
    Result<std::vector<Frame>> receive(const DrawFrames& frames);
    Result<std::vector<Frame>> draw(const DrawFrames& frames);
    // Of the frame drawn last.
    Status write_picture(const std::string& file);
    Status finish();

private:
    explicit Program(std::unique_ptr<ChildProcess> child) : child_(std::move(child)) {}

    std::unique_ptr<ChildProcess> child_;
    Hello hello_;
};

struct ProgramPair {
    // What a process finds on its stack depends on the length of its path: both are run through links.
    std::unique_ptr<TemporaryFolder> links;
    std::unique_ptr<Program> base, head;

    // Fresh processes of both. They load at the same time; an error is the first one's.
    static Result<ProgramPair> start(const Programs& programs, bool base_first, const Patience& patience);
    // Both end by themselves.
    Status finish();
};

// Whether the two draw the same: recording, size, device, settings.
Status check_alike(const Hello& base, const Hello& head);

} // namespace sunfleck::gate
