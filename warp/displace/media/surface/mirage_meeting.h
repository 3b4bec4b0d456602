/// Where rays that mirages move meet the depth buffer: what TileMeeting does for other rays (depth_meeting.h).
///
/// The surface itself stands in for the pixels of ground (mirage_ground.h): they block no ray, and the ray ends where
/// it meets the surface. The march leaps over ground as long as no object is near. The ways FixedPoint and Own, too,
/// take the depth of a pixel of ground to be the one where the ray ends.
///
/// A ray may pass behind an object, where the picture does not show what it sees. It may come out again and go on. It
/// may also end on something hidden: then the ground beside the object that is as deep stands in, or, if the ray does
/// not end on the ground, what lies behind the object. If there is nothing of the kind, the last visible point before
/// the object's outline stands in.
///
/// A ray that passes over the ground for good stays clear of the horizon and of the feet of objects, whose pixels show
/// some ground. So does a pixel that no mirage moves: the ground that it shows beside a mirror is not there any more.
#pragma once

#include <memory>
#include <span>

#include "warp/displace/depth/depth_meeting.h"
#include "warp/displace/media/surface/mirage.h"

namespace eikonal {

/// For the same tile, way and bound as TileMeeting, and for rows with the benders of these mirages. depth and mirages
/// must outlive it. Null if there are no mirages.
std::unique_ptr<const BentMeeting> mirage_meeting(const DepthPlane& depth, const PixelWindow& tile, DepthMeeting how,
                                                  int largest_shift, std::span<const Mirage> mirages);

}  // namespace eikonal
