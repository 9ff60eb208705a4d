#pragma once

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace thicket {

/// The state of a tile in the streamer.
struct StreamedTile {
	glm::ivec3 at{0};         ///< Column, row and slab.
	std::uint64_t ticket = 0; ///< Ticket of the pending request; 0 if there is none.
	std::uint32_t viewer = 0; ///< Index of the viewer for which the tile was requested.
	double traveled = 0.0;    ///< TrackedViewer::flown of this viewer at the time of the request.
	bool exists = false;
	bool visible = false;
	bool current = false;  ///< True if the tile is visible and not outdated.
	bool late = false;     ///< True if the tile is pending and became outdated after the request.
	bool is_ready = false; ///< True if the tile is pending, generated, and ready to be displayed.

	bool waiting() const { return !current && ticket == 0; }
	bool begun() const { return visible || ticket != 0; }
};

/// A hash table of tiles by coordinates. A tile's slot in the table never changes.
class TileTable {
public:
	static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

	/// Returns the slot of a tile, or `none` if it is not in the table.
	std::uint32_t find(glm::ivec3 at) const;

	/// Returns the slot of a tile and adds the tile if it is missing. If memory runs out, throws
	/// std::bad_alloc and adds nothing.
	std::uint32_t find_or_add(glm::ivec3 at);
	void erase(std::uint32_t slot) noexcept;
	void clear();

	StreamedTile &operator[](std::uint32_t slot) { return tiles_[slot]; }
	const StreamedTile &operator[](std::uint32_t slot) const { return tiles_[slot]; }

	std::size_t size() const { return tiles_.size() - free_.size(); }

	/// Returns all slots. Skip the slots for which `exists` is false.
	std::vector<StreamedTile> &slots() { return tiles_; }
	const std::vector<StreamedTile> &slots() const { return tiles_; }

private:
	std::size_t home(glm::ivec3 at) const;
	std::size_t bucket_of(glm::ivec3 at) const;
	void grow();

	std::vector<StreamedTile> tiles_;
	std::vector<std::uint32_t> free_;
	/// Slots by hash, with linear probing; `none` where empty. The size is a power of two.
	std::vector<std::uint32_t> buckets_;
};

} // namespace thicket
