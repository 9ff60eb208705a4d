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

/// Finds out where the ground under visible tiles has changed without a report: compares a few heights of a few tiles at a time, in turn,
/// with those that the tiles were made with. Pure logic: the caller reads the ground and the clock. Times are seconds of any clock. Methods
/// that add throw std::bad_alloc.
class GroundRecheck {
public:
	/// A tile is visible from now on, made with these heights; one that was visible before has been regenerated. `outdated`: it is about
	/// to be regenerated once more, so it is not checked until then.
	void show(const TileKey &key, const Rect &rect, std::vector<GroundProbe> probes, bool outdated);
	void hide(const TileKey &key);
	void clear();

	/// The visible tiles of a layer that touch `area` are about to be regenerated: they are not checked until the next `show`, or until
	/// `keep`, for one that stays as it is. Changes found there in tiles of this layer are dropped, since the caller knows them.
	void hold(std::uint32_t layer, const Rect &area);
	void keep(const TileKey &key);

	/// Replaces `r_positions` by those to read next, `most` at the most: two of each tile whose turn it is. Work is bounded whatever the
	/// number of tiles.
	void next(double now, std::size_t most, std::vector<glm::dvec2> &r_positions);

	/// Takes the heights at these positions, NAN for no ground, none where the ground cannot be read at present. Those that differ by more
	/// than `tolerance` meters are changes; each is found once.
	void answer(double now, std::span<const std::optional<float>> heights, double tolerance);

	/// The positions of changes, once a tile's pause has passed since the first of them, or when there are many: tiles that lie over each
	/// other are then regenerated together.
	std::vector<glm::dvec2> take_changes(double now);
	bool has_changes() const { return !changes_.empty(); }

	std::size_t size() const { return tiles_.size(); }

	/// Seconds between two checks of a tile. Each change doubles it, up to 8 s, until heights stay the same. So ground that never comes
	/// to rest does not keep all workers busy.
	static constexpr double pause = 0.25;

private:
	struct Before {
		bool operator()(const TileKey &a, const TileKey &b) const;
	};

	struct Tile {
		Rect rect;
		std::vector<GroundProbe> probes;
		std::size_t next = 0;      ///< Of `probes`.
		double due = 0.0;          ///< When it is to be checked.
		unsigned unrest = 0;       ///< The more of it, the longer the pause: see pause_of.
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
	TileKey next_; ///< The tile to look at next, or the one after it.
	std::vector<Asked> asked_;
	std::vector<Change> changes_;
	double first_change_ = 0.0;
	std::uint64_t versions_ = 0;
};

} // namespace thicket
