#pragma once

#include "core/base/status.hpp"
#include "core/placement/layer.hpp"

#include <array>
#include <cstddef>
#include <span>

namespace thicket {

/// A layer and all layers that it looks at, directly or through others, each of them once however many ways lead to it.
/// Takes no memory; the layer must live as long.
class NeighborChain {
public:
	struct Link {
		const LayerSettings *layer = nullptr;
		double margin = 0.0;   ///< Meters: the longest way from the layer itself, as the sum of distances.
		std::size_t depth = 0; ///< The most steps on a way.
	};

	explicit NeighborChain(const LayerSettings &layer);

	/// Why there is no such chain: a neighbor or a distance that is refused, too many of them, too long a way.
	const Status &status() const { return status_; }

	/// Those that are looked at stand before those that look at them; the layer itself is the last. Empty unless ok.
	std::span<const Link> links() const { return std::span(links_).first(status_.ok() ? size_ : 0); }

private:
	void add(const LayerSettings &layer, std::size_t depth);
	Link *find(const LayerSettings *layer);
	void find_margins();

	Status status_;
	std::array<Link, max_chain_layers> links_;
	std::size_t size_ = 0;
};

} // namespace thicket
