#pragma once

#include "core/placement/layer.hpp"

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace thicket {

/// How a layer refers to a different layer: by name, by index in the list, or by identity. Exactly one of the three is
/// set.
struct LayerReference {
	std::string name;           ///< If two layers share a name, it refers to the first.
	std::int64_t index = -1;    ///< Not negative.
	std::uint64_t identity = 0; ///< LayerLinks::identity, for a layer that may have no name.

	LayerReference() = default;
	LayerReference(std::string name) : name(std::move(name)) {}
	LayerReference(const char *name) : name(name) {}

	/// True if it refers to no layer.
	bool empty() const { return name.empty() && index < 0 && identity == 0; }

	friend auto operator<=>(const LayerReference &, const LayerReference &) = default;
};

/// A layer's own name and identity, and its references to other layers.
struct LayerLinks {
	std::string name;           ///< Empty if there is none.
	std::uint64_t identity = 0; ///< A number that is unique to this layer; 0 if there is none.

	/// Meters to keep from other layers; 0 for no spacing. If both layers of a pair set a distance, the larger one counts. The later layer
	/// keeps the distance.
	std::map<LayerReference, double> spacing;

	/// The layer near whose instances this one is placed; empty if there is none. Only a layer earlier in the list counts.
	LayerReference proximity_layer;
	double proximity_distance = 0.0;                   ///< Meters; 0 if unused.
	std::shared_ptr<const CurveTable> proximity_curve; ///< See Neighbor::curve; null disables proximity.

	/// Layers whose distance drives the colors and the variations; empty if there are none. Only layers earlier in the list count.
	LayerReference color_layer;
	LayerReference variation_layer;

	friend bool operator==(const LayerLinks &, const LayerLinks &) = default;
};

/// A layer before its references are resolved. Both pointers are null for an index without a layer.
struct UnlinkedLayer {
	const LayerSettings *settings = nullptr; ///< Without neighbors and source layers.
	const LayerLinks *links = nullptr;
};

using SharedLayer = std::shared_ptr<const LayerSettings>;

/// A layer after its references are resolved.
struct LinkedLayer {
	SharedLayer settings; ///< With neighbors and source layers; null if there is no layer at this index.
	Status status;        ///< The reason if the layer kept its previous settings.
};

/// An additional check that may refuse a layer, with its neighbors, at an index of the list.
using LayerCheck = std::function<Status(const LayerSettings &layer, std::size_t index)>;

/// Resolves references into pointers. Every layer gets the earlier layers as neighbors that it refers to or that refer
/// to it, and the earlier layers that its sources depend on. Missing layers keep their index and become no neighbors.
/// `before` contains the results of the last call, by index. A result that is equal to its previous result is returned
/// as the same pointer. A layer that is refused (too many neighbors, too long a chain, a distance out of range, or by
/// `check`) keeps its previous settings.
std::vector<LinkedLayer> link_layers(
		std::span<const UnlinkedLayer> layers, std::span<const SharedLayer> before, const LayerCheck &check = {});

/// A name that is not yet taken: `name` itself, else `name` with the lowest free number from 2 on, as in "Oak 2".
std::string free_layer_name(std::string_view name, std::span<const std::string> taken);

/// Likely mistakes in a layer's name and references, one sentence each. Mistakes are references to no layer or to the
/// layer itself, a name that an earlier layer has, and proximity to a layer that does not come earlier in the list. The
/// same applies to a layer that a color follows. `layers[index]` must not be null; others may be.
std::vector<std::string> name_problems(std::span<const LayerLinks *const> layers, std::size_t index);

} // namespace thicket
