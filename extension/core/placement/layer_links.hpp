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

/// How a layer speaks of another: by its name, by its index in the list, or by its identity. One of the three is set.
struct LayerReference {
	std::string name;           ///< Of two layers of one name, the first is meant.
	std::int64_t index = -1;    ///< Not negative.
	std::uint64_t identity = 0; ///< LayerLinks::identity, for a layer that may have no name.

	LayerReference() = default;
	LayerReference(std::string name) : name(std::move(name)) {}
	LayerReference(const char *name) : name(name) {}

	/// True if no layer is meant.
	bool empty() const { return name.empty() && index < 0 && identity == 0; }

	friend auto operator<=>(const LayerReference &, const LayerReference &) = default;
};

/// What a layer says of itself and of others.
struct LayerLinks {
	std::string name;           ///< Empty for none.
	std::uint64_t identity = 0; ///< A number that no other layer has; 0 for none.

	/// Meters to keep to other layers; 0 for none. Of a pair, the larger of what both say counts, and the later layer gives
	/// way.
	std::map<LayerReference, double> spacing;

	/// A layer whose instances this one stands near; empty for none. Only one that stands before it counts.
	LayerReference proximity_layer;
	double proximity_distance = 0.0;                   ///< Meters; 0 for none.
	std::shared_ptr<const CurveTable> proximity_curve; ///< See Neighbor::curve; without one, proximity does not count.

	/// Layers whose distance the colors, and the variations, follow; empty for none. Only ones that stand before it count.
	LayerReference color_layer;
	LayerReference variation_layer;

	friend bool operator==(const LayerLinks &, const LayerLinks &) = default;
};

/// A layer as it is described before others are known. Both pointers are null for a layer that is not there.
struct UnlinkedLayer {
	const LayerSettings *settings = nullptr; ///< Without neighbors and layers of sources.
	const LayerLinks *links = nullptr;
};

using SharedLayer = std::shared_ptr<const LayerSettings>;

/// What came of a layer's references.
struct LinkedLayer {
	SharedLayer settings; ///< With its neighbors and layers of sources; null for a layer that is not there.
	Status status;        ///< Why the layer kept the settings that it had before.
};

/// A further reason to refuse a layer, with its neighbors, at an index of the list.
using LayerCheck = std::function<Status(const LayerSettings &layer, std::size_t index)>;

/// Turns references into pointers: every layer gets those before it as neighbors that it refers to, or that refer to it, and
/// those before it that its sources look at.
/// Layers that are not there keep their index and are nobody's neighbors. What comes out equal to `before`, the layers of
/// the last call by index, is the same pointer; what is refused (too many neighbors, too long a chain, a distance out of
/// range, or by `check`) keeps its settings from there.
std::vector<LinkedLayer> link_layers(
		std::span<const UnlinkedLayer> layers, std::span<const SharedLayer> before, const LayerCheck &check = {});

/// A name that is not among those taken: `name` itself, else `name` with the lowest number from 2 on, as in "Oak 2".
std::string free_layer_name(std::string_view name, std::span<const std::string> taken);

/// What is likely not meant by a layer's name and references, a sentence each: references to no layer or to the layer itself,
/// proximity to a layer, or a color that follows one, that does not stand before it, a name that an earlier layer has. `layers[index]` must not be
/// null, others may be.
std::vector<std::string> name_problems(std::span<const LayerLinks *const> layers, std::size_t index);

} // namespace thicket
