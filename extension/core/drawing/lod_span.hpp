#pragma once

#include "core/base/view_volume.hpp"
#include "core/drawing/lod.hpp"

#include <glm/vec4.hpp>

#include <cstddef>
#include <cstdint>
#include <span>

namespace thicket {

/// One step in the sequence of meshes that replace each other with distance.
struct LodStep {
	bool same = false;  ///< The mesh is the same as in the previous step.
	bool fades = false; ///< The mesh's materials can fade.

	friend bool operator==(const LodStep &, const LodStep &) = default;
};

/// The meshes that are drawn for the instances in a box: `first` to `last`. Each is drawn for the instances in its
/// range of distances.
struct LodSpan {
	std::size_t first = 0;
	std::size_t last = 0;
	bool ends = false; ///< Some instances fade out at the end of sight.

	friend bool operator==(const LodSpan &, const LodSpan &) = default;
};

/// The meshes for a box. If two consecutive meshes both fade, both are drawn in boxes that overlap the range of the cross-fade. That range
/// runs from (1 - settings.fade) times the distance of the change to that distance. Elsewhere the whole box changes abruptly, as in lod_at.
/// `shown` is the span that is displayed now. A mesh appears a little before it is needed and is removed a little after, so that a viewer
/// who moves back and forth causes no uploads. `steps` has one entry for each mesh, including the nearest.
LodSpan lod_span(const LodSettings &settings, std::span<const LodStep> steps, const DistanceRange &distance,
		const LodSpan &shown);

/// How much the distances may change before lod_span must be called again. Meters, 0 or more; infinite if nothing changes.
double span_margin(const LodSettings &settings, std::span<const LodStep> steps, const DistanceRange &distance);

/// The range in which a mesh is visible, in the layout of scatter_fade.gdshaderinc. x and y are meters from a viewer at which its fade-in
/// ends and its fade-out ends; y is negative at the end of sight. z is the share of either distance, up to it, over which it fades. w is
/// the height limit of sight_distance.
using FadeRange = glm::vec4;

/// The far end of a mesh's range: none, the next mesh, or the end of sight.
enum class LodEnd : std::uint8_t { stays, next, sight };

/// The fade range of the mesh of the steps `first` to `last`, which are the same. If `comes` is true, it replaces the mesh of the previous
/// step.
FadeRange fade_range(const LodSettings &settings, std::size_t first, std::size_t last, bool comes, LodEnd end);

/// The fade range of a mesh that neither fades in nor out.
inline constexpr FadeRange no_fade{0.0F, 1e9F, 0.0F, 0.0F};

} // namespace thicket
