#pragma once

#include "nodes/drawing/displayed_tile.hpp"
#include "nodes/workers/tile_workers.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

namespace thicket {

/// A tile on its way from the workers to the display.
struct TileUpload {
	std::shared_ptr<TileJob> job;

	DisplayedTile tile;                                    ///< The parts uploaded until now, hidden.
	std::vector<std::shared_ptr<const CompactMesh>> shown; ///< The instances to upload for each mesh, once it is begun.
	std::uint64_t overlay_version = 0;                     ///< The version of the overlay when the upload was begun.

	bool is_begun() const { return tile.tile != nullptr; }
	bool is_complete() const { return is_begun() && tile.parts.size() >= shown.size() && !has_open_part(); }

	/// The last part has cells that are not uploaded yet.
	bool has_open_part() const { return !tile.parts.empty() && tile.parts.back().is_open(); }
};

/// Finished tiles that wait for their upload, and the current tile, which is uploaded part by part over several frames.
/// TileDisplay draws the tiles. Main thread only.
class UploadQueue {
public:
	enum class State : std::uint8_t {
		idle,      ///< There is no current tile.
		uploading, ///< Parts of the current tile are still to be uploaded.
		complete,  ///< The current tile is uploaded, and waits to be taken or put back.
	};

	State state() const { return state_; }

	/// Queues a finished job.
	void push(std::shared_ptr<TileJob> job);

	/// Makes a waiting tile the current one. Call it only while no tile is current. Returns false if no tile with this
	/// ticket waits.
	bool choose(std::uint64_t ticket);

	/// The current tile. Call `part_uploaded` after each upload of a part.
	TileUpload &current() { return current_; }
	void part_uploaded();

	/// Returns the current tile and leaves the queue idle.
	TileUpload take();

	/// Returns the current tile to the queue, with the parts that are already uploaded.
	void put_back();

	/// Removes a waiting or current tile; empty if there is none with this ticket.
	std::optional<TileUpload> remove(std::uint64_t ticket);

	/// The number of waiting tiles, including the current one.
	std::size_t size() const { return waiting_.size() + (state_ != State::idle ? 1 : 0); }
	void clear();

private:
	State state_ = State::idle;
	TileUpload current_;
	std::unordered_map<std::uint64_t, TileUpload> waiting_; ///< By ticket.
};

} // namespace thicket
