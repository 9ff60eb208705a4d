#pragma once

#include "core/base/rect.hpp"
#include "core/streaming/tile_streamer.hpp"

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// The tiles of one layer and what is known of each. A part of TileStreamer, which says what the states mean.
class LayerTiles {
public:
	/// A tile that waits to be requested.
	struct Waiting {
		double distance_squared; ///< To the nearest viewer.
		std::uint32_t layer;
		glm::ivec2 tile;
	};

	LayerTiles(std::uint32_t layer, const StreamLayer &settings, std::uint32_t grid) :
			layer_(layer), settings_(settings), grid_(grid) {}

	const StreamLayer &settings() const { return settings_; }
	std::size_t pending() const { return pending_; }
	bool has_retired() const { return !retired_.empty(); }

	/// Takes new settings; a new tile size retires what is on show, cancels the rest, and starts `new_grid`.
	void configure(const StreamLayer &settings, std::uint32_t new_grid, StreamChanges &r_changes);

	/// What touches `area` is outdated. What is under way stays so, and is outdated when it comes.
	void invalidate(const Rect &area);

	/// Cancels what is under way; it waits to be requested again.
	void cancel_all(StreamChanges &r_changes);

	/// Cancels and drops everything.
	void clear(StreamChanges &r_changes);

	/// Finds out which tiles are wanted, kept and gone. Returns false, at no cost, if the viewers are still where they
	/// were to within an eighth of a tile and nothing else has changed.
	bool look(std::span<const Viewer> viewers, StreamChanges &r_changes);

	/// Drops retired tiles under which nothing is missing: all is there, or out of view.
	void drop_covered(StreamChanges &r_changes);

	/// Adds the tiles that wait to be requested.
	void add_waiting(std::vector<Waiting> &r_waiting) const;

	/// Turns a waiting tile into a pending one.
	TileRequest request(glm::ivec2 tile, std::uint64_t ticket);

	/// See TileStreamer::finish. `r_again` says that the tile waits to be requested again at once.
	bool finish(const TileRequest &request, bool &r_again);

	void count(StreamCounts &r_counts) const;

private:
	struct Tile {
		glm::ivec2 at{0};
		double distance_squared = 0.0;
		std::uint64_t ticket = 0; ///< Of the pending request; 0 for none.
		bool shown = false;
		bool current = false; ///< Shown, and not outdated.
		bool late = false;    ///< Pending, and outdated since it was requested.

		bool waiting() const { return !current && ticket == 0; }
	};

	/// On show from a grid of another size, until tiles of the present one cover it.
	struct Retired {
		TileKey key;
		Rect rect;
	};

	bool viewers_stayed(std::span<const Viewer> viewers) const;
	void find_wanted();
	double nearest_squared(const Rect &rect) const;
	bool kept(const Rect &rect) const;
	void release(const Tile &tile, StreamChanges &r_changes);
	void cancel(Tile &tile, StreamChanges &r_changes);
	bool is_missing_under(const Rect &rect) const;
	Tile *find(glm::ivec2 at);
	TileKey key(glm::ivec2 at) const { return {layer_, grid_, at}; }

	std::uint32_t layer_;
	StreamLayer settings_;
	std::uint32_t grid_;
	bool changed_ = true; ///< The next look has to be a real one.
	std::size_t pending_ = 0;
	std::vector<Viewer> viewers_; ///< Where the last look found them.
	std::vector<Tile> tiles_;     ///< Sorted by row, then column, as are the next two.
	std::vector<Tile> wanted_;    ///< Working memory of `look`.
	std::vector<Tile> merged_;
	std::vector<Retired> retired_;
};

} // namespace thicket
