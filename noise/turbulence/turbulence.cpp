/// The hooks of [[medium]] type = "turbulence": each form is a medium of its own.
#include "noise/base/error.h"
#include "noise/medium/optics.h"
#include "noise/turbulence/gradient_noise/gradient_noise_medium.h"
#include "noise/turbulence/lattice/lattice_medium.h"
#include "noise/turbulence/parameters/turbulence_spec.h"
#include "noise/turbulence/screens/screens_medium.h"

namespace eikonal {

std::string why_still(const TurbulenceSpec& spec, const OpticsSpec& optics) {
    return spec.source() * force_strength(optics) == 0 ? "its strength is zero" : "";
}

std::unique_ptr<const Medium> build_medium(const TurbulenceSpec& spec, const MediumSetting& setting) {
    try {
        switch (spec.form) {
            case TurbulenceForm::Lattice:
                return std::make_unique<const LatticeMedium>(spec, setting);
            case TurbulenceForm::GradientNoise:
                return std::make_unique<const GradientNoiseMedium>(spec, setting);
            case TurbulenceForm::Screens:
                break;
        }
        return std::make_unique<const ScreensMedium>(spec, setting);
    } catch (const UserError& error) {
        throw UserError(setting.name + ": " + error.what());
    }
}

void mix_seeds(TurbulenceSpec& spec, const RandomStream& stream) {
    spec.seed = stream.bits(spec.seed);
}

}  // namespace eikonal
