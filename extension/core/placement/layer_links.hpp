#pragma once

#include "core/placement/layer.hpp"

#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace thicket {

/// A layer as it is described before others are known: it speaks of them by name.
struct NamedLayer {
	std::string name;       ///< Empty: nobody can speak of it.
	LayerSettings settings; ///< Without neighbors.

	/// Meters to keep to other layers, by their names; 0 for none. Of a pair, the larger of what both say counts, and
	/// the later layer gives way.
	std::map<std::string, double> spacing;

	/// A layer whose instances this one stands near; empty for none. Only one that stands before it counts.
	std::string proximity_layer;
	double proximity_distance = 0.0;                   ///< Meters; 0 for none.
	std::shared_ptr<const CurveTable> proximity_curve; ///< See Neighbor::curve; without one, proximity does not count.
};

using SharedLayer = std::shared_ptr<const LayerSettings>;

/// What came of a layer's names.
struct LinkedLayer {
	SharedLayer settings; ///< With its neighbors; null for a layer that is not there.
	Status status;        ///< Why the layer kept the settings that it had before.
};

/// A further reason to refuse a layer, with its neighbors, at an index of the list.
using LayerCheck = std::function<Status(const LayerSettings &layer, std::size_t index)>;

/// Turns names into pointers: every layer gets those before it as neighbors that it, or they, name. Null entries keep
/// their index and are nobody's neighbors; of two layers of one name, the first is meant. What comes out equal to
/// `before`, the layers of the last call by index, is the same pointer; what is refused (too many neighbors, too long
/// a chain, a distance out of range, or by `check`) keeps its settings from there.
std::vector<LinkedLayer> link_layers(
		std::span<const NamedLayer *const> layers, std::span<const SharedLayer> before, const LayerCheck &check = {});

/// What is likely not meant by a layer's names, a sentence each: names of no layer, proximity to a layer that does not
/// stand before it, a name that an earlier layer has. `layers[index]` must not be null.
std::vector<std::string> name_problems(std::span<const NamedLayer *const> layers, std::size_t index);

} // namespace thicket
