// Two running programs that draw what they are asked for.
#pragma once

#include "editor/gate/child_process.h"
#include "editor/gate/protocol.h"

namespace sunfleck::gate {

// The two command lines. Both are run under paths of equal length, so that neither has another stack.
struct Programs {
    std::vector<std::string> base, head;
};

// A child that has said hello.
class Program {
public:
    explicit Program(std::unique_ptr<ChildProcess> child) : child_(std::move(child)) {}
    Status read_hello();
    const Hello& hello() const { return hello_; }

    Status request(const DrawFrames& frames);
    Result<std::vector<Frame>> receive(const DrawFrames& frames);
    Result<std::vector<Frame>> draw(const DrawFrames& frames);
    // Of the frame drawn last.
    Status write_picture(const std::string& file);
    Status finish();

private:
    std::unique_ptr<ChildProcess> child_;
    Hello hello_;
};

// Links to both programs, gone with the object.
class ProgramLinks;

struct ProgramPair {
    std::shared_ptr<const ProgramLinks> links;
    std::unique_ptr<Program> base, head;

    // Fresh processes of both. They load at the same time; an error is the first one's.
    static Result<ProgramPair> start(const Programs& programs, bool base_first, const Patience& patience);
    // Both end by themselves.
    Status finish();
};

// Whether the two draw the same: recording, size, device, settings.
Status check_alike(const Hello& base, const Hello& head);

} // namespace sunfleck::gate
