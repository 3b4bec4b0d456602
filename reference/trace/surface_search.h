/// Finds where a curved ray first meets the objects of a scene.
///
/// The ray comes as steps (integrator.h). It is cut into chords, and each chord is tested against the geometry as one
/// segment. A chord ends where the curve might deviate from it by more than is allowed. A curve of length l that turns
/// by β stays within βl/4 of its chord. A curve whose curvature is at most κ stays within κl²/8. Gentle bending
/// therefore costs few segments, whatever the number of steps. Strong bending costs several segments a step.
///
/// The hit of a chord is refined on the curve itself, against the tangent plane at the hit. The surface is then tested
/// once more along the ray's tangent. The point found lies on the curve up to rounding. If the test finds nothing,
/// because the chord cuts what the curve passes, the chord is halved.
///
/// An object can be missed only where the curve enters it by less than the allowed deviation. Embree holds positions in
/// float, so chords overlap by what that may lose (kFloatSlack).
#pragma once

#include <array>
#include <optional>

#include "reference/trace/geometry.h"
#include "reference/trace/integrator.h"

namespace eikonal::reference {

/// Largest error of a position in Embree, relative to its distance from the anchor.
inline constexpr double kFloatSlack = 1e-6;
/// The most chords of one step, whatever the tolerance. Hits are refined from any of them.
inline constexpr int kMostChords = 64;

class SurfaceSearch {
  public:
    /// How far a chord may leave the curve: `angle` [rad] times the distance from the camera, plus `width` [m].
    struct Deviation {
        double angle = 0, width = 0;
    };

    /// A meeting with a surface, at the part theta of a step.
    struct Met {
        Hit hit;  ///< the surface. Its t has no meaning.
        Step step;
        double theta = 0;
    };

    /// geometry: null if there is nothing to meet. distance: length of path from the camera to the ray's start [m] >=
    /// 0.
    SurfaceSearch(const Geometry* geometry, const Deviation& deviation, double distance)
        : geometry_(geometry), deviation_(deviation), start_(distance), distance_(distance) {}

    /// Adds the next step, which begins where the last one ended. length, bend: step.length() and step.bend(). kink: by
    /// how much the direction jumps at the step's start [rad].
    std::optional<Met> add(const Step& step, double length, double bend, double kink = 0);
    /// Tests the chord that is left. To be called at the end of the ray.
    std::optional<Met> finish();

    /// A meeting lies on one of this number of last steps.
    static constexpr int kMostPieces = 8;

  private:
    /// A chord between the places `from` and `until` of the curve, which are the points a and b.
    struct Chord {
        double from, until;
        dvec3 a, b;
    };

    double room(double curvature) const;
    std::optional<Met> close(double until);
    std::optional<Met> test(const Chord& chord, double travelled, int depth) const;
    double place_after(double from, double until, double way) const;
    std::optional<Met> refine(double from, double until, double guess, double back, double distance,
                              const Hit& chord_hit) const;
    int piece_of(double place) const;
    const Step& piece(int index) const { return *pieces_[static_cast<std::size_t>(index)]; }
    dvec3 position(double place) const;
    double plane_root(double from, double until, double guess, const Hit& hit) const;

    const Geometry* geometry_;
    Deviation deviation_;
    double start_;            ///< length of path before the ray [m]
    double distance_;         ///< length of path to the end of the chord so far [m]
    double chord_start_ = 0;  ///< place on the curve where the chord starts: index of the piece plus theta
    dvec3 chord_from_{0};
    double chord_length_ = 0, chord_bend_ = 0;
    double chord_curvature_ = 0;  ///< the largest curvature [1/m]. Infinite if there is a kink.
    int count_ = 0;
    std::array<std::optional<Step>, kMostPieces> pieces_;  ///< the first count_ are set
};

}  // namespace eikonal::reference
