#include "gi_module/visibility/visibility_settings.h"

namespace sunfleck::gi {

const TypeDescription& VisibilitySettings::description() {
    static const TypeDescription type{
        "VisibilitySettings",
        1,
        "The visibility database.",
        {SUNFLECK_FIELD(VisibilitySettings, patch_levels, "", 0, 6,
                        "How often patches of surfaces are divided at most"),
         SUNFLECK_CHOICE(VisibilitySettings, visibility_tests,
                         "Granularity of mover visibility tests: clusters of samples against a hierarchy of nodes, "
                         "each sample down the trees of nodes, or every pair by itself; all find the same",
                         "clusters", "trees", "pairs")}};
    return type;
}

} // namespace sunfleck::gi
