// A device under validation for the whole test program.
#pragma once

#include "engine/gpu/device.h"
#include "tests/support/pinned_driver.h"

#include <cstdio>
#include <cstdlib>
#include <gtest/gtest.h>
#include <memory>

namespace sunfleck::tests {

// Made once; every test that uses it checks that validation stayed silent.
inline gpu::Device& device() {
    static const std::unique_ptr<gpu::Device> instance = [] {
        pin_driver();
        gpu::DeviceOptions options;
        options.validation = true;
        auto made = gpu::Device::create(options);
        if (!made) {
            std::fprintf(stderr, "%s\n", made.error().message.c_str());
            std::abort();
        }
        return std::move(made).value();
    }();
    return *instance;
}

class GpuTest : public testing::Test {
protected:
    void SetUp() override { messages_ = device().validation_messages(); }
    void TearDown() override { EXPECT_EQ(device().validation_messages(), messages_) << "validation printed something"; }

private:
    int messages_ = 0;
};

} // namespace sunfleck::tests
