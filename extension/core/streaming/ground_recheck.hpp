#pragma once

#include "core/base/ground_probe.hpp"
#include "core/base/rect.hpp"
#include "core/streaming/tile_streamer.hpp"

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

namespace thicket {

/// Detects unreported changes to the ground under visible tiles. It checks the tiles in turn and
/// compares a few heights of each tile with those from which the tile was generated. The class only
/// makes decisions: the caller reads the ground and the clock. Times are in seconds from any
/// starting point. Methods that add entries throw std::bad_alloc.
class GroundRecheck {
public:
	/// Reports that a tile generated from these heights has become visible or was regenerated. If
	/// `outdated` is true, the tile is about to be regenerated again and is not checked until then.
	void show(const TileKey &key, const Rect &rect, std::vector<GroundProbe> probes, bool outdated);
	void hide(const TileKey &key);
	void clear();

	/// Reports that the visible tiles of a layer that touch `area` are about to be regenerated.
	/// They are not checked until the next `show` or, for a tile that turns out unchanged, until
	/// `keep`. Changes found in `area` for this layer are discarded, because the caller is already
	/// handling them.
	void suspend(std::uint32_t layer, const Rect &area);
	void keep(const TileKey &key);

	/// Replaces `r_positions` with at most `max_count` positions to read next, two for each tile
	/// that is due. Each call visits a limited number of tiles.
	void next(double now, std::size_t max_count, std::vector<glm::dvec2> &r_positions);

	/// Processes the heights at the positions from `next`, in the same order. NAN means no ground;
	/// an empty value means that the ground cannot be read at present. A height that differs by
	/// more than `tolerance` meters is a change. Each change is reported once.
	void answer(double now, std::span<const std::optional<float>> heights, double tolerance);

	/// Returns and removes the positions of changes. The result is empty until `pause` seconds
	/// after the first change, unless there are many changes, so that overlapping tiles can be
	/// regenerated together.
	std::vector<glm::dvec2> take_changes(double now);
	bool has_changes() const { return !changes_.empty(); }

	std::size_t size() const { return tiles_.size(); }

	/// Seconds between two checks of a tile. Each change doubles the pause of its tile, up to 8 s,
	/// and unchanged heights shorten it again. Ground that moves constantly therefore does not keep
	/// all workers busy.
	static constexpr double pause = 0.25;

private:
	struct Before {
		bool operator()(const TileKey &a, const TileKey &b) const;
	};

	struct Tile {
		Rect rect;
		std::vector<GroundProbe> probes;
		std::size_t next = 0;      ///< Index in `probes` of the next probe.
		double due = 0.0;          ///< Time of the next check.
		unsigned unrest = 0;       ///< Number of recent changes. It determines the pause; see pause_of.
		std::uint64_t version = 0; ///< A new number for each `show`.
		bool is_suspended = false;
	};

	struct Change {
		std::uint32_t layer = 0;
		glm::dvec2 position{0.0};
	};

	struct Asked {
		TileKey key;
		std::uint64_t version = 0;
		std::size_t probe = 0;
	};

	void visit(
			const TileKey &key, Tile &r_tile, double now, std::size_t max_count, std::vector<glm::dvec2> &r_positions);

	std::map<TileKey, Tile, Before> tiles_;
	/// The tile to check next. If it no longer exists, the tile that follows in the order is
	/// checked.
	TileKey next_;
	std::vector<Asked> queried_;
	std::vector<Change> changes_;
	double first_change_ = 0.0;
	std::uint64_t versions_ = 0;
};

} // namespace thicket
