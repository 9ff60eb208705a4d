#pragma once

#include "core/base/rect.hpp"
#include "core/placement/layer.hpp"

#include <map>
#include <utility>
#include <vector>

namespace thicket {

/// Where a layer's instances may have changed.
struct EditedArea {
	bool everywhere = false;
	std::vector<Rect> areas; ///< World meters, none within another; of no account if `everywhere`.

	bool empty() const { return !everywhere && areas.empty(); }

	/// Whether any of it lies in the half-open `rect`, its edges included.
	bool touches(const Rect &rect) const;

	/// Adds an area, grown by `distance` meters on all sides.
	void add(const Rect &area, double distance = 0.0);
	void add(const EditedArea &other, double distance = 0.0);
};

/// An area and all that lies within `distance` meters (0 or more) of it, and a hair more, for what rounding may do.
Rect grown(const Rect &area, double distance);

/// Tells from the settings of layers before and after, on the same ground, where their instances may have changed:
/// under the shapes and the pixels of masks that are not the same as before, and as far around as a layer looks for its
/// edge or for the instances of other layers, as a rule or for the look of its own. Remembers what it found, so that layers which share neighbors cost
/// little more than one; so the settings must live as long as the search.
class EditSearch {
public:
	/// For the layer itself: its instances, how they stand and which mesh they have. All of it, if anything but masks
	/// and shapes has changed, in the layer or in a rule of its neighbors; or if memory does not suffice to tell.
	const EditedArea &find(const LayerSettings &before, const LayerSettings &after);

private:
	using Pair = std::pair<const LayerSettings *, const LayerSettings *>;

	const EditedArea &find_edits(const LayerSettings &before, const LayerSettings &after);
	const EditedArea &find_standing(const LayerSettings &before, const LayerSettings &after);

	std::map<Pair, EditedArea> found_;    ///< For the layer itself.
	std::map<Pair, EditedArea> standing_; ///< For its neighbors: where something stands, no matter how.
};

} // namespace thicket
