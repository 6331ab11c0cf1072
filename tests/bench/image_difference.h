#pragma once

#include <xgc/bake/image.h>

namespace xgc::bench {

/// Of the luma (BT.601, of the pictures' sRGB values) of two pictures of one size.
struct ImageDifference {
    double psnr = 0; ///< decibels; 99 where they are equal
    double ssim = 0; ///< Wang et al. 2004, mean over windows of 8 x 8 pixels, 4 apart; 1 where they are equal
};
ImageDifference imageDifference(const bake::Image& a, const bake::Image& b);

} // namespace xgc::bench
