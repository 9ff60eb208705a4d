#pragma once

#include "core/base/rect.hpp"
#include "core/placement/layer.hpp"

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace thicket {

/// The area in which a layer's instances may have changed.
struct EditedArea {
	bool everywhere = false;
	std::vector<Rect> areas; ///< World meters. No area contains another one. Meaningless if `everywhere` is true.

	bool empty() const { return !everywhere && areas.empty(); }

	/// Returns true if any part of the area touches the half-open `rect`, edges included.
	bool touches(const Rect &rect) const;

	/// Adds an area, expanded by `distance` meters on all sides.
	void add(const Rect &area, double distance = 0.0);
	void add(const EditedArea &other, double distance = 0.0);
};

/// The areas in which a game has changed the instances of hosts, keyed by the host's
/// PointSet::layer.
using HostEdits = std::map<std::uint16_t, EditedArea>;

/// Returns an area expanded by `distance` meters (0 or more) on all sides, plus a small margin for
/// rounding.
Rect grown(const Rect &area, double distance);

/// Finds the area in which instances may have changed between two versions of a layer's settings,
/// on the same ground. The area consists of changed rows, shapes, mask pixels, biomes and water. It is
/// expanded by the edge feather and by the distances at which layers depend on other layers. The
/// search caches results, so that several layers with common neighbors cost little more than one.
/// The settings must therefore outlive the search.
class EditSearch {
public:
	/// `host_edits` contains the areas of the game's changes between the two versions.
	explicit EditSearch(HostEdits host_edits = {}) : host_edits_(std::move(host_edits)) {}

	/// Returns the area in which the layer's instances may have changed, including their transforms
	/// and meshes. The area covers everything if any other setting of the layer has changed, or the
	/// rules of a neighbor or host, or the models or transforms of a host. It also covers
	/// everything if memory runs out.
	const EditedArea &find(const LayerSettings &before, const LayerSettings &after);

private:
	using Pair = std::pair<const LayerSettings *, const LayerSettings *>;

	const EditedArea &find_edits(const LayerSettings &before, const LayerSettings &after);
	const EditedArea &find_standing(const LayerSettings &before, const LayerSettings &after);
	EditedArea find_host_edits(const LayerSettings &before, const LayerSettings &after);
	void add_measured_edits(const LayerSettings &before, const LayerSettings &after,
			bool (*uses)(const LayerSettings &, const WorldInput &), double distance, EditedArea &r_area);

	HostEdits host_edits_;
	std::map<Pair, EditedArea> found_; ///< Areas in which instances or their appearance may have changed.
	/// Areas in which instances may have been added or removed, for layers on which others depend.
	std::map<Pair, EditedArea> present_areas_;
};

} // namespace thicket
