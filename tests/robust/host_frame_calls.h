// The frames of a random sequence of a host's calls: updates with callbacks, pictures of changing size, with and
// without optional images, frames that are dropped. What each call returns is judged.
#pragma once

#include "tests/robust/random_host_values.h"

#include <stdexcept>

namespace sunfleck::tests {

// What the context's log leads to while a sequence runs; null: nothing.
using LogHook = std::function<void()>;

// Judges each call by its status: right or refused, and of an abandoned context all are refused.
class JudgedCalls : protected RandomHostValues {
public:
    Tally tally;
    std::string log;

protected:
    JudgedCalls(std::uint32_t seed, HostProgram& program, host::Context& context)
        : RandomHostValues(seed), program_(program), context_(context) {}

    void expect(const Status& status, const char* call, const std::string& why = "") {
        ++tally.tried;
        ++tally.calls[call];
        log += std::string(" ") + call + (wrong_ ? "!" : "");
        if (abandoned_)
            return expect_lost(status, call);
        const bool named = !status && status.error().code == ErrorCode::argument && !status.error().message.empty();
        tally.refused += named && wrong_;
        tally.right += bool(status) && !wrong_;
        if (wrong_ ? !named : !status) {
            ++tally.wrong;
            ADD_FAILURE() << call << (wrong_ ? " should be refused " : " should succeed ") << why << ": "
                          << (status ? "it succeeds" : status.error().message);
        }
    }
    // Ended by the host's own callback.
    void expect_ended(const Status& status, const char* call, ErrorCode code) {
        ++tally.tried;
        ++tally.calls[call];
        log += std::string(" ") + call;
        const bool right = !status && status.error().code == code;
        (right ? tally.refused : tally.wrong) += 1;
        EXPECT_TRUE(right) << call << ": " << (status ? "it succeeds" : status.error().message);
    }
    // A call from a callback.
    void expect_busy(const Status& status, const char* call) {
        ++tally.tried;
        ++tally.calls[call];
        const bool named = !status && status.error().code == ErrorCode::argument &&
                           status.error().message.find("within another call") != std::string::npos;
        (named ? tally.refused : tally.wrong) += 1;
        EXPECT_TRUE(named) << call << ": " << (status ? "it succeeds" : status.error().message);
    }
    void call_back(std::uint32_t which, const char* from) {
        switch (which % 6) {
        case 0:
            return expect_busy(context_.clear(), from);
        case 1:
            return expect_busy(context_.update({}), from);
        case 2:
            return expect_busy(context_.set("lights", "4"), from);
        case 3:
            return expect_busy(context_.set_transform(which % 5, host::identity), from);
        case 4:
            return expect_busy(without_value(context_.add_light({})), from);
        default:
            return expect_busy(context_.record(program_.commands(), program_.camera(), program_.images()), from);
        }
    }

    HostProgram& program_;
    host::Context& context_;
    bool abandoned_ = false;

private:
    // Of an abandoned context: wrong arguments may be named first.
    void expect_lost(const Status& status, const char* call) {
        const bool named =
            !status && !status.error().message.empty() &&
            (status.error().code == ErrorCode::device_lost || (wrong_ && status.error().code == ErrorCode::argument));
        (named ? tally.refused : tally.wrong) += 1;
        EXPECT_TRUE(named) << call << " of an abandoned context: " << (status ? "it succeeds" : status.error().message);
    }
};

class FrameCalls : public JudgedCalls {
protected:
    FrameCalls(std::uint32_t seed, HostProgram& program, host::Context& context, LogHook& hook)
        : JudgedCalls(seed, program, context), hook_(hook) {}

    void frame() {
        const bool wrong_frame = wrong_ && chance(), wrong_record = wrong_ && !wrong_frame;
        host::Frame frame = program_.next_frame();
        frame.map_budget = chance() ? 5 : 0xffffffffu;
        wrong_ = wrong_frame;
        if (wrong_) {
            refused_update(frame);
            program_.submit_empty();
            return;
        }
        if (!update(frame)) {
            program_.submit_empty();
            return;
        }
        if (pick(8) == 0) { // the one before it stays to be recorded
            wrong_ = true;
            refused_update(frame);
            wrong_ = false;
        }
        const bool small = pick(4) == 0;
        if (small != (program_.width() < 32))
            ++tally.calls["another size"];
        program_.resize(small);
        const bool recorded = record(wrong_record);
        const std::uint32_t fate = pick(8);
        if (!recorded || fate == 0) {
            program_.submit_empty(); // the commands are lost
            if (recorded)
                drop(frame.serial);
        } else {
            program_.submit();
            recorded_ = frame.serial;
        }
    }

private:
    enum class Answer { go_on, stop, end_by_exception, call_back };

    void refused_update(host::Frame frame) {
        if (chance())
            frame.serial = recorded_ > 0 ? pick(2) * recorded_ : 0;
        else
            frame.completed_serial = frame.serial + pick(3);
        expect(context_.update(frame), "update");
    }
    // False: a callback ended it. How often one is called depends on the machine; what it does, on the seed alone.
    bool update(host::Frame frame) {
        const std::uint32_t kind = pick(8), which = pick(1000);
        const Answer answer = kind < 2   ? Answer::stop
                              : kind < 4 ? Answer::end_by_exception
                              : kind < 7 ? Answer::call_back
                                         : Answer::go_on;
        bool asked = false;
        if (pick(4) > 0)
            frame.progress = [&](float) {
                if (answer == Answer::call_back && !asked)
                    call_back(which, "call from progress");
                asked = true;
                if (answer == Answer::end_by_exception)
                    throw std::runtime_error("of the host's");
                return answer != Answer::stop;
            };
        bool logged = false;
        hook_ = [&] {
            if (!std::exchange(logged, true))
                call_back(which, "call from log");
        };
        const Status status = context_.update(frame);
        hook_ = {};
        if (asked && answer == Answer::stop) {
            expect_ended(status, "update that is stopped", ErrorCode::stopped);
            return false;
        }
        if (asked && answer == Answer::end_by_exception) {
            expect_ended(status, "update with an exception", ErrorCode::other);
            return false;
        }
        expect(status, "update");
        return true;
    }
    Status record_by_view(const host::FrameImages& images) {
        host::View view;
        view.view_to_clip = host::view_projection(program_.camera(), program_.width(), program_.height());
        if (wrong_ && chance())
            view.view_to_clip = host::Matrix4{};
        else if (wrong_)
            spoil(chance() ? std::span<float>(view.world_to_view) : std::span<float>(view.view_to_clip));
        return context_.record(program_.commands(), view, images);
    }
    host::FrameImages some_images() {
        if (chance())
            return program_.images();
        HostOptions options;
        for (bool* option : {&options.shading_normals, &options.geometric_normals, &options.motion,
                             &options.metallic_roughness, &options.specular})
            *option = chance();
        ++tally.calls["optional images"];
        return program_.images(options);
    }
    bool record(bool with_mistake) {
        const host::FrameImages good = some_images();
        if (with_mistake) {
            wrong_ = true;
            host::FrameImages images = good;
            const std::uint32_t mistake = pick(4);
            if (mistake == 0)
                spoil_images(images);
            if (mistake == 3) {
                expect(record_by_view(images), "record(view)");
            } else {
                wrong_ = mistake == 1;
                const host::Camera eye = camera(program_.camera());
                wrong_ = true;
                expect(context_.record(mistake == 2 ? VK_NULL_HANDLE : program_.commands(), eye, images), "record");
            }
            // May be followed by another try, or by another update.
            if (chance())
                return false;
        }
        wrong_ = false;
        program_.draw(context_.surface_id(pick(6)));
        if (pick(4) == 0)
            expect(record_by_view(good), "record(view)");
        else
            expect(context_.record(program_.commands(), program_.camera(), good), "record");
        return true;
    }
    void drop(std::uint64_t serial) {
        host::Frame next = program_.next_frame();
        next.dropped = true;
        expect(context_.update(next), "update after a dropped frame");
        program_.submit_empty();
        recorded_ = serial;
    }

    LogHook& hook_;
    std::uint64_t recorded_ = 0;
};

} // namespace sunfleck::tests
