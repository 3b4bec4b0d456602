/// One [[medium]] of a scene, of any kind: its parameters, and what follows from them before anything is built.
///
/// A kind of medium is a struct P of parameters and some functions beside it, the hooks. MediumSpec finds them by
/// argument-dependent lookup. Every kind has:
///     P::kType                                  its `type` in the scene file
///     keys(P&)                                  its keys, with ranges, units and defaults (noise/medium/keys.h)
///     why_still(const P&, const OpticsSpec&)    why it bends no light, empty if it may: the only test of strength
///     build_medium(const P&, const MediumSetting&)   the medium of a shot (noise/medium/medium.h); UserError
/// Some kinds have:
///     P::kAbsoluteIndex = true                  its index is absolute, and it must be the only medium of a scene
///     mix_seeds(P&, const RandomStream&)        makes its seeds depend on the scene's
///     mirage_ground(const P&, const OpticsSpec&)     the plane over which it makes mirages, if it makes any
/// MediumSpec is a value. A copy of it has a copy of the parameters.
#pragma once

#include <concepts>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "noise/medium/ground_plane.h"
#include "noise/medium/keys.h"
#include "noise/medium/medium.h"
#include "noise/medium/medium_hooks.h"

namespace eikonal {

template <class P>
concept MediumParameters = std::copyable<P> &&
    requires(P parameters, const P& constant, const OpticsSpec& optics, const MediumSetting& setting) {
    { P::kType } -> std::convertible_to<std::string_view>;
    { keys(parameters) } -> std::same_as<Keys>;
    { why_still(constant, optics) } -> std::same_as<std::string>;
    { build_medium(constant, setting) } -> std::same_as<std::unique_ptr<const Medium>>;
};

namespace detail {

/// A copyable box of parameters of any kind.
struct Holder {
    virtual ~Holder() = default;
    virtual std::unique_ptr<Holder> clone() const = 0;
    virtual std::string_view type() const = 0;
    virtual bool has_absolute_index() const = 0;
    virtual Keys list_keys() = 0;
    virtual std::string still(const OpticsSpec& optics) const = 0;
    virtual std::unique_ptr<const Medium> build(const MediumSetting& setting) const = 0;
    virtual void mix(const RandomStream& stream) = 0;
    virtual std::optional<GroundPlane> ground(const OpticsSpec& optics) const = 0;
};

template <class P>
struct Held final : Holder {
    explicit Held(P p) : parameters(std::move(p)) {}
    std::unique_ptr<Holder> clone() const override { return std::make_unique<Held>(parameters); }
    std::string_view type() const override { return P::kType; }
    bool has_absolute_index() const override {
        if constexpr (requires { P::kAbsoluteIndex; }) return P::kAbsoluteIndex;
        return false;
    }
    Keys list_keys() override { return keys(parameters); }
    std::string still(const OpticsSpec& optics) const override { return why_still(parameters, optics); }
    std::unique_ptr<const Medium> build(const MediumSetting& setting) const override {
        return build_medium(parameters, setting);
    }
    void mix(const RandomStream& stream) override {
        if constexpr (requires(P & p) { mix_seeds(p, stream); }) mix_seeds(parameters, stream);
    }
    std::optional<GroundPlane> ground(const OpticsSpec& optics) const override {
        if constexpr (requires { mirage_ground(parameters, optics); }) return mirage_ground(parameters, optics);
        return {};
    }
    P parameters;
};

}  // namespace detail

class MediumSpec {
  public:
    /// Implicit, so that a list of parameters is a list of media.
    template <class P>
    requires(!std::same_as<P, MediumSpec> && MediumParameters<P>)
        MediumSpec(P parameters)  // NOLINT(google-explicit-constructor)
        : held_(std::make_unique<detail::Held<P>>(std::move(parameters))) {}
    MediumSpec(const MediumSpec& other) : held_(other.held_->clone()) {}
    MediumSpec(MediumSpec&&) noexcept = default;
    MediumSpec& operator=(MediumSpec other) noexcept {
        held_ = std::move(other.held_);
        return *this;
    }
    ~MediumSpec() = default;

    /// The parameters, if they are of kind P; else null.
    template <class P>
    const P* get_if() const {
        const auto* held = dynamic_cast<const detail::Held<P>*>(held_.get());
        return held ? &held->parameters : nullptr;
    }
    template <class P>
    P* get_if() {
        auto* held = dynamic_cast<detail::Held<P>*>(held_.get());
        return held ? &held->parameters : nullptr;
    }

    std::string_view type() const { return held_->type(); }
    bool has_absolute_index() const { return held_->has_absolute_index(); }
    /// The keys of its table, except `type`. They point to the parameters in this object.
    Keys keys() { return held_->list_keys(); }
    /// Why it bends no light under these optics; empty if it may.
    std::string why_still(const OpticsSpec& optics) const { return held_->still(optics); }
    /// Builds the medium; never null. UserError: what the kind refuses.
    std::unique_ptr<const Medium> build(const MediumSetting& setting) const { return held_->build(setting); }
    void mix_seeds(const RandomStream& stream) { held_->mix(stream); }
    /// The plane over which it makes mirages; none if it makes none.
    std::optional<GroundPlane> mirage_ground(const OpticsSpec& optics) const { return held_->ground(optics); }

  private:
    std::unique_ptr<detail::Holder> held_;
};

}  // namespace eikonal
