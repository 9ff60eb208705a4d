#pragma once

#include "core/base/view_volume.hpp"
#include "core/placement/lod.hpp"

#include <glm/vec4.hpp>

#include <cstddef>
#include <cstdint>
#include <span>

namespace thicket {

/// One of the meshes that follow each other with distance.
struct LodStep {
	bool same = false;  ///< It is the mesh of the step before: nothing changes here.
	bool fades = false; ///< Its materials can fade.

	friend bool operator==(const LodStep &, const LodStep &) = default;
};

/// What is drawn of the instances in a box: the meshes `first` to `last`, each for the instances that are as far away as it is for.
struct LodSpan {
	std::size_t first = 0;
	std::size_t last = 0;
	bool ends = false; ///< Some instances fade out at the end of sight.

	friend bool operator==(const LodSpan &, const LodSpan &) = default;
};

/// The meshes for a box. Where two meshes that follow each other both fade, both are drawn in boxes that reach into the distances between which the one
/// becomes the other, (1 - settings.fade) times the distance of the change to that distance. Elsewhere the whole box changes at once, as lod_at
/// says. `shown` is what is drawn now: a mesh comes a little before it is needed, and goes a little after, so that who walks to and fro sees nothing
/// uploaded. `steps` has one for each mesh, the one for near by included.
LodSpan lod_span(const LodSettings &settings, std::span<const LodStep> steps, const DistanceRange &distance,
		const LodSpan &shown);

/// How much the distances may change before lod_span is to be asked again. Meters, 0 or more, infinite where nothing changes.
double span_margin(const LodSettings &settings, std::span<const LodStep> steps, const DistanceRange &distance);

/// Where a mesh comes and goes, as scatter_fade.gdshaderinc takes it: meters from a viewer at which its fade-in ends, and its fade-out, which is
/// negative for the end of sight; the share of either distance, up to it, over which it fades; and the height limit of sight_distance.
using FadeRange = glm::vec4;

/// How a mesh goes with distance.
enum class LodEnd : std::uint8_t { stays, next, sight };

/// Of the mesh of the steps `first` to `last`, which are the same. With `comes`, it takes over from the step before.
FadeRange fade_range(const LodSettings &settings, std::size_t first, std::size_t last, bool comes, LodEnd end);

/// Of a mesh that neither comes nor goes.
inline constexpr FadeRange no_fade{0.0F, 1e9F, 0.0F, 0.0F};

} // namespace thicket
