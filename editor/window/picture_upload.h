// Pictures of the CPU, as the GUI shows them.
#pragma once

#include "editor/window/scene_thread.h"

namespace sunfleck::editor {

// From display values, 0 to 1, which are rounded to 8 bits; `pixels` of the result are the rounded ones.
Result<std::shared_ptr<ScenePicture>> upload_picture(gpu::Device& device, gpu::Submission& submission,
                                                     const io::Picture& picture);

} // namespace sunfleck::editor
