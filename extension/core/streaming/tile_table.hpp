#pragma once

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace thicket {

/// The streamer's state of a tile.
struct StreamedTile {
	glm::ivec2 at{0};
	std::uint64_t ticket = 0; ///< The ticket of the pending request; 0 if there is none.
	std::uint32_t viewer = 0; ///< The viewer that it was requested for.
	double flown = 0.0;       ///< Meters that this viewer had flown at the time of the request.
	bool exists = false;
	bool shown = false;
	bool current = false; ///< Shown and not outdated.
	bool late = false;    ///< Pending, and outdated since the request.
	bool made = false;    ///< Pending, and its answer is ready to be shown.

	bool waiting() const { return !current && ticket == 0; }
	bool begun() const { return shown || ticket != 0; }
};

/// Tiles by their coordinates. Each tile keeps its slot number as long as it is in the table.
class TileTable {
public:
	static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

	/// The slot of a tile, or `none` if it is not in the table.
	std::uint32_t find(glm::ivec2 at) const;

	/// The slot of a tile, which is added if it is missing. Throws std::bad_alloc without adding it.
	std::uint32_t find_or_add(glm::ivec2 at);
	void erase(std::uint32_t slot) noexcept;
	void clear();

	StreamedTile &operator[](std::uint32_t slot) { return tiles_[slot]; }
	const StreamedTile &operator[](std::uint32_t slot) const { return tiles_[slot]; }

	std::size_t size() const { return tiles_.size() - free_.size(); }

	/// All slots. Skip those where `exists` is false.
	std::vector<StreamedTile> &slots() { return tiles_; }
	const std::vector<StreamedTile> &slots() const { return tiles_; }

private:
	std::size_t home(glm::ivec2 at) const;
	std::size_t bucket_of(glm::ivec2 at) const;
	void grow();

	std::vector<StreamedTile> tiles_;
	std::vector<std::uint32_t> free_;
	std::vector<std::uint32_t>
			buckets_; ///< Open addressing, linear: slots by hash, `none` where empty. A power of 2 in size.
};

} // namespace thicket
