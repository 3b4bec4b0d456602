/// Finds where a curved ray first meets the objects of a scene.
///
/// The ray comes as steps (integrator.h). It is cut into chords, each shot at the geometry as one segment; a chord ends
/// where the ray has turned so far that it may leave it by more than the allowed deviation: a curve of length l that
/// turns by β stays within βl/4 of its chord, one of curvature κ at most within κl²/8. So gentle bending costs few
/// segments however many steps it took, and a strong one many a step. A chord's hit is then refined on the curve itself
/// against the tangent plane there, and the surface shot at once more along the ray's tangent: the point found is on
/// the curve to rounding. Where that finds nothing, because the chord cuts what the curve passes, the chord is halved.
///
/// So an object can be missed only where the curve enters it by less than the allowed deviation.
/// Embree holds positions in float: chords overlap by what that may lose (kFloatSlack).
#pragma once

#include <array>
#include <optional>

#include "reference/trace/geometry.h"
#include "reference/trace/integrator.h"

namespace eikonal::reference {

/// Largest error of a position in Embree, relative to the distance from its anchor.
inline constexpr double kFloatSlack = 1e-6;
/// The most chords a step is cut into, whatever the tolerance; hits are refined from any of them.
inline constexpr int kMostChords = 64;

class SurfaceSearch {
  public:
    /// How far a chord may leave the curve: `angle` [rad] times the distance from the camera, plus `width` [m].
    struct Deviation {
        double angle = 0, width = 0;
    };

    /// A meeting: part theta of a step.
    struct Met {
        Hit hit;  ///< point, normal … of the surface; its t is of no use
        Step step;
        double theta = 0;
    };

    /// geometry: nothing is ever met without. distance: path from the camera to the ray's start [m] >= 0.
    SurfaceSearch(const Geometry* geometry, const Deviation& deviation, double distance)
        : geometry_(geometry), deviation_(deviation), start_(distance), distance_(distance) {}

    /// Steps follow each other without gaps; length, bend: step.length(), step.bend(); `kink` is how far the direction
    /// jumps at the start of this one [rad].
    std::optional<Met> add(const Step& step, double length, double bend, double kink = 0);
    /// Tests what is left. Call it at the end of the ray.
    std::optional<Met> finish();

    /// A meeting lies on one of as many last steps.
    static constexpr int kMostPieces = 8;

  private:
    /// Between two places on the curve, and these.
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
    double start_;            ///< path before the ray [m]
    double distance_;         ///< path up to the end of the chord so far [m]
    double chord_start_ = 0;  ///< place on the curve where the chord starts: index of the piece plus theta
    dvec3 chord_from_{0};
    double chord_length_ = 0, chord_bend_ = 0;
    double chord_curvature_ = 0;  ///< the largest [1/m]; infinite if it has a kink
    int count_ = 0;
    std::array<std::optional<Step>, kMostPieces> pieces_;  ///< the first count_ are there
};

}  // namespace eikonal::reference
