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

/// A finished tile that is waiting for its upload or being uploaded.
struct TileUpload {
	std::shared_ptr<TileJob> job;

	/// The parts uploaded so far, still hidden.
	DisplayedTile tile;
	/// The instances to upload for each mesh. Set when the upload begins.
	std::vector<std::shared_ptr<const CompactMesh>> displayed_meshes;
	/// The version of the game's changes (the overlay) when the upload began.
	std::uint64_t overlay_version = 0;

	bool is_begun() const { return tile.tile != nullptr; }
	bool is_complete() const { return is_begun() && tile.parts.size() >= displayed_meshes.size() && !has_open_part(); }

	/// Returns true if the last part has cells that have not been uploaded yet.
	bool has_open_part() const { return !tile.parts.empty() && tile.parts.back().is_open(); }
};

/// The finished tiles that are waiting for their upload, and the current tile, which is uploaded
/// part by part over several frames. TileDisplay uploads and draws these tiles. Use it only on the
/// main thread.
class UploadQueue {
public:
	enum class State : std::uint8_t {
		idle,      ///< There is no current tile.
		uploading, ///< Parts of the current tile have not been uploaded yet.
		complete,  ///< The current tile is uploaded and must be taken or put back.
	};

	State state() const { return state_; }

	/// Queues a finished job.
	void push(std::shared_ptr<TileJob> job);

	/// Makes the waiting tile whose request has this ticket (a unique number) the current one. Call
	/// it only while there is no current tile. Returns false if there is no such tile.
	bool choose(std::uint64_t ticket);

	/// Returns the current tile. Call `part_uploaded` after each upload of a part.
	TileUpload &current() { return current_; }
	void part_uploaded();

	/// Returns the current tile and leaves the queue idle.
	TileUpload take();

	/// Returns the current tile to the queue, along with the parts that have been uploaded.
	void put_back();

	/// Removes the waiting or current tile with this ticket and returns it. Returns nothing if
	/// there is no such tile.
	std::optional<TileUpload> remove(std::uint64_t ticket);

	/// Returns the number of waiting tiles, including the current one.
	std::size_t size() const { return waiting_tiles_.size() + (state_ != State::idle ? 1 : 0); }
	void clear();

private:
	State state_ = State::idle;
	TileUpload current_;
	std::unordered_map<std::uint64_t, TileUpload> waiting_tiles_; ///< The waiting tiles, keyed by ticket.
};

} // namespace thicket
