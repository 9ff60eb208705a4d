#pragma once

#include "core/base/rect.hpp"
#include "core/placement/layer.hpp"

#include <map>
#include <utility>
#include <vector>

namespace thicket {

/// The area in which a layer's instances may have changed.
struct EditedArea {
	bool everywhere = false;
	std::vector<Rect> areas; ///< World meters, none within another; meaningless if `everywhere` is set.

	bool empty() const { return !everywhere && areas.empty(); }

	/// Whether any part of the area lies in the half-open `rect`, including its edges.
	bool touches(const Rect &rect) const;

	/// Adds an area, expanded by `distance` meters on all sides.
	void add(const Rect &area, double distance = 0.0);
	void add(const EditedArea &other, double distance = 0.0);
};

/// An area expanded by `distance` meters (0 or more), plus a small margin for rounding.
Rect grown(const Rect &area, double distance);

/// Compares layer settings before and after a change, on the same ground, and finds where their instances may have
/// changed. These are the areas of changed shapes, mask pixels, biomes and water. Each area is expanded by the distance
/// up to which a layer checks for its edge, and by the distance up to which a layer depends on other layers, by a rule
/// or for the look of its instances. The search caches its results, so layers that share neighbors cost little more
/// than one. The settings must therefore outlive the search.
class EditSearch {
public:
	/// The area for the layer itself: its instances, their transforms and their meshes. Covers everything if anything
	/// but the mask, shapes, biomes and water has changed, in the layer or in a rule of its neighbors, or if memory
	/// runs out.
	const EditedArea &find(const LayerSettings &before, const LayerSettings &after);

private:
	using Pair = std::pair<const LayerSettings *, const LayerSettings *>;

	const EditedArea &find_edits(const LayerSettings &before, const LayerSettings &after);
	const EditedArea &find_standing(const LayerSettings &before, const LayerSettings &after);

	std::map<Pair, EditedArea> found_;    ///< For the layer itself.
	std::map<Pair, EditedArea> standing_; ///< For its neighbors: where instances may appear or vanish.
};

} // namespace thicket
