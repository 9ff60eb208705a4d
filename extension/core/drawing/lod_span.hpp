#pragma once

#include "core/base/view_volume.hpp"
#include "core/drawing/lod.hpp"

#include <glm/vec4.hpp>

#include <cstddef>
#include <cstdint>
#include <span>

namespace thicket {

/// One mesh in the sequence of meshes that replace each other with distance.
struct LodStep {
	bool same_mesh = false; ///< True if the mesh is the same as in the previous step.
	bool fades = false;     ///< True if the mesh's materials can fade.

	friend bool operator==(const LodStep &, const LodStep &) = default;
};

/// The meshes that are drawn for the instances in a box, from `first` to `last`. Each mesh is
/// visible only for the instances in its range of distances.
struct LodSpan {
	std::size_t first = 0;
	std::size_t last = 0;
	bool fades_out = false; ///< True if some instances fade out at `sight_end`.

	friend bool operator==(const LodSpan &, const LodSpan &) = default;
};

/// Returns the meshes to draw for a box. If two consecutive meshes both fade, both are drawn in
/// boxes that overlap the range of their cross-fade. That range is from (1 - settings.fade) times
/// the distance of the change to the distance itself. Meshes that do not fade change abruptly for
/// the whole box, as in lod_at. `displayed_span` is the currently displayed span. A mesh is added a
/// little before it is needed and removed a little after, so that a viewer moving back and forth
/// causes no uploads. `steps` has one entry for each mesh, including the finest.
LodSpan lod_span(const LodSettings &settings, std::span<const LodStep> steps, const DistanceRange &distance,
		const LodSpan &displayed_span);

/// Returns how far the distance may change, in meters, without affecting the result of lod_span. The
/// value is at least 0, or infinity if the result never changes.
double span_margin(const LodSettings &settings, std::span<const LodStep> steps, const DistanceRange &distance);

/// The range of distances in which a mesh is visible, in the layout of scatter_fade.gdshaderinc.
/// The fade-in ends at x meters, and the fade-out at |y| meters. The component y is negative if the
/// mesh fades out at the end of the view distance. The component z is the fraction of these
/// distances over which the mesh fades, and w is the height limit of sight_distance.
using FadeRange = glm::vec4;

/// The transition at the far end of a mesh's range: none (`stays`), a fade into the next mesh, or a
/// fade-out at the view distance (`sight`).
enum class LodEnd : std::uint8_t { stays, next, sight };

/// Returns the fade range of the mesh in the steps `first` to `last`, which must all have this
/// mesh. If `fades_in` is true, the mesh fades in and replaces the mesh of the previous step.
FadeRange fade_range(const LodSettings &settings, std::size_t first, std::size_t last, bool fades_in, LodEnd end);

/// The fade range of a mesh that neither fades in nor out.
inline constexpr FadeRange no_fade{0.0F, 1e9F, 0.0F, 0.0F};

} // namespace thicket
