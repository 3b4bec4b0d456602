#include "noise/medium/keys.h"
#include "noise/profile/profile_spec.h"

namespace eikonal {

static EnumNames<ProfileKind> names(ProfileKind) {
    static constexpr std::pair<std::string_view, ProfileKind> list[] = {{"luneburg", ProfileKind::Luneburg},
                                                                        {"fish-eye", ProfileKind::FishEye},
                                                                        {"linear", ProfileKind::Linear},
                                                                        {"linear-squared", ProfileKind::LinearSquared},
                                                                        {"exponential", ProfileKind::Exponential},
                                                                        {"rod", ProfileKind::Rod},
                                                                        {"sech", ProfileKind::Sech}};
    return list;
}

Keys keys(ProfileSpec& p) {
    using enum ProfileKind;
    return {
        {"profile", "which closed form", p.profile},
        {"center", "", "m", p.center},
        direction_key("axis", "along which the index changes", p.axis)
            .only_with("profile", p.profile, {Linear, LinearSquared, Exponential, Rod, Sech}),
        Key("radius", "", "m", p.radius, {positive()}).only_with("profile", p.profile, {Luneburg, FishEye}),
        Key("n0", "index at the center", p.n0, {positive()})
            .only_with("profile", p.profile, {FishEye, Linear, LinearSquared, Exponential, Rod, Sech}),
        Key("slope", "per metre", p.slope).only_with("profile", p.profile, {Linear, LinearSquared, Exponential}),
        Key("g", "", "1/m", p.g).only_with("profile", p.profile, {Rod, Sech}),
    };
}

}  // namespace eikonal
