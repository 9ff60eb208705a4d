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

/// Detects ground changes under visible tiles that were not reported. Compares a few heights of a few tiles at a time,
/// in turn, with the heights from which the tiles were generated. Pure logic: the caller reads the ground and the
/// clock. Times are seconds of any clock. Methods that add entries throw std::bad_alloc.
class GroundRecheck {
public:
	/// Reports that a tile, generated with these heights, is visible from now on. A tile that was visible before has been regenerated.
	/// `outdated` means that it is about to be regenerated once more, so it is not checked until then.
	void show(const TileKey &key, const Rect &rect, std::vector<GroundProbe> probes, bool outdated);
	void hide(const TileKey &key);
	void clear();

	/// Reports that the visible tiles of a layer that touch `area` are about to be regenerated. They are not checked until the next
	/// `show`, or until `keep` for an unchanged tile. Drops changes found there in tiles of this layer, because the caller already knows
	/// about them.
	void hold(std::uint32_t layer, const Rect &area);
	void keep(const TileKey &key);

	/// Replaces `r_positions` with the positions to read next, at most `most`: two of each tile whose turn it is. The work is bounded,
	/// whatever the number of tiles.
	void next(double now, std::size_t most, std::vector<glm::dvec2> &r_positions);

	/// Takes the heights at these positions. NAN means no ground; an empty value means that the ground cannot be read at present. A
	/// height that differs by more than `tolerance` meters is a change. Each change is found once.
	void answer(double now, std::span<const std::optional<float>> heights, double tolerance);

	/// Returns the positions of changes, once a tile's pause has passed since the first of them or when there are many. Overlapping tiles
	/// are then regenerated together.
	std::vector<glm::dvec2> take_changes(double now);
	bool has_changes() const { return !changes_.empty(); }

	std::size_t size() const { return tiles_.size(); }

	/// Seconds between two checks of a tile. Each change doubles it, up to 8 s, until the heights stay the same. Ground that never comes
	/// to rest therefore does not keep all workers busy.
	static constexpr double pause = 0.25;

private:
	struct Before {
		bool operator()(const TileKey &a, const TileKey &b) const;
	};

	struct Tile {
		Rect rect;
		std::vector<GroundProbe> probes;
		std::size_t next = 0;      ///< Index in `probes`.
		double due = 0.0;          ///< Time of the next check.
		unsigned unrest = 0;       ///< The higher, the longer the pause; see pause_of.
		std::uint64_t version = 0; ///< Changes with each `show`.
		bool held = false;
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

	void visit(const TileKey &key, Tile &r_tile, double now, std::size_t most, std::vector<glm::dvec2> &r_positions);

	std::map<TileKey, Tile, Before> tiles_;
	TileKey next_; ///< The tile to check next, or the one after it.
	std::vector<Asked> asked_;
	std::vector<Change> changes_;
	double first_change_ = 0.0;
	std::uint64_t versions_ = 0;
};

} // namespace thicket
