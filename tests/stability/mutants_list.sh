# The mutants of tests/stability/mutants.sh: FILE TESTS SOURCES WHAT SED. Files by name, with a folder if two share it.
t=projection_stability_test.cpp f=project_kernels.h
mutant $f $t "" "determinant as a c - b²" 's/p\.det = ctx\.det_raw .*;/p.det = p.cov_xx * p.cov_yy - b * b;/'
mutant $f $t "" "unblurred determinant as a c - b²" 's/ctx\.det_raw = dot.*;/ctx.det_raw = a * c - b * b;/'
mutant $f $t "" "slope of the Jacobian not clamped" 's/clamp3\(slope_x, camera\.x_lo, camera\.x_hi\)/slope_x/'
mutant $f $t "" "no floor of the compensation" 's/sqrt\(max2\(ratio, T\(kCompensationFloor2\)\)\)/sqrt(ratio)/'
mutant $f $t "" "gradient of the opacity as 1 - s" 's/sigmoid\(-ctx\.logit_opacity\)/(T(1) - sigmoid(ctx.logit_opacity))/'
mutant $f $t "" "direction of a zero offset" 's/length2 > T\(0\) \? T\(1\) \/ sqrt\(length2\) : T\(0\)/T(1) \/ sqrt(length2)/'
mutant $f "$t splat_grad_test.cpp" "" "off-diagonal gradient not halved" 's/g\.conic_b \/ T\(2\)/g.conic_b/'
mutant splat_gaussian.h $t "" "no near plane" 's/t\.z > camera\.near_z && double/double/'
mutant splat_gaussian.h $t "" "positions subtracted in float" 's/using W = WideOf<S>;/using W = S;/'
f=splat_gaussian.h
mutant $f cull_test.cpp "" "cull: two sigma instead of three" 's/kRadii = 3\.5/kRadii = 2/'
mutant $f cull_test.cpp "" "cull: row length of the Jacobian without the slope" 's/portable_hypot\(1\.0, std::max\(-lo, hi\)\)/1.0/'
mutant $f cull_test.cpp "" "cull: no low-pass filter" 's/ \+ blur_px \* z\)/)/'
mutant $f cull_test.cpp "" "cull: first scale instead of the largest" 's/exp_at_least\(largest\)/exp_at_least(float(log_scale[0]))/'
mutant stable.h cull_test.cpp "" "cull: exp_at_least below exp" 's/1065354000/1065353100/'
mutant quat.h $t "" "norm without scaling" 's/q\.([xyzw]) \/ largest/q.\1/g'
mutant quat.h $t "" "zero quaternion not caught" 's/if \(!\(largest > T\(0\)\)\)/if (false)/'
mutant quat.h "$t splat_grad_test.cpp" "" "normalisation gradient not orthogonal to q" 's/const T along = .*;/const T along = T(0);/'

t=elementary_stability_test.cpp f=stable.h
mutant $f $t "" "sigmoid as e^x / (1 + e^x)" 's/if \(x >= T\(0\)\) return .*;//'
mutant $f $t "" "softplus as log(1 + e^x)" 's/x > T\(0\) \? x \+ log1p_of\(exp_of\(-x\)\) : log1p_of\(exp_of\(x\)\)/log1p_of(exp_of(x))/'
mutant $f $t "" "1 - e^-x as a difference" 's/return -expm1_of\(-x\);/return T(1) - exp_of(-x);/'
mutant $f $t "" "logit as -log(1 / p - 1)" 's/log_of\(p\) - log1p_of\(-p\)/-log_of(T(1) \/ p - T(1))/'
mutant $f $t "" "slope of the sigmoid one-sided" 's/exp_of\(x < T\(0\) \? x : -x\)/exp_of(-x)/'
mutant lane_scalar.h $t "" "exp2 polynomial one degree lower" 's/L p\(1\.5326471e-4f\)/L p(0.f)/'
mutant lanes_avx2.h $t "" "masked-out lanes of 2^x not cleared" 's/_mm256_and_si256\(power, .*\)\)\);/power));/'
mutant lane_scalar.h $t "" "exp2 polynomial with a wrong coefficient" 's/9\.618506e-3f/9.62e-3f/'
mutant exact_sum.h $t "" "carry lost" 's/\(fraction < other\.fraction \? 1 : 0\)/0/'
mutant exact_sum.h $t "" "32 bits of fraction" 's/std::uint64_t\(\(x - floor\) \* 0x1p64\)/std::uint64_t((x - floor) * 0x1p32) << 32/'
mutant exact_sum.h $t "" "value in float" 's/return double\(whole\) \+/return double(float(whole)) +/'

t=compositing_stability_test.cpp f=splat_tiles.h
mutant splat_step_kernels.h $t "tile_isa.cpp" "alpha not capped" 's/min_lanes\(L\(.*\)\), (exp2_where\(reached, exponent\))\)/\1/'
mutant $f $t "tile_isa.cpp" "pixels never stop" 's/and_at_least\(live\[pack\], after, stop\)/and_at_least(live[pack], after, zero)/'
mutant $f $t "tile_isa.cpp" "a stopped pixel continues" 's/and_at_least\(live\[pack\], after, stop\)/after >= stop/'
mutant tile_rows.h splat_rows_test.cpp "" "rows: no rounding slack of the border" 's/G\(T\(4 \* kEps\)\)/G(T(0))/'
mutant tile_rows.h splat_rows_test.cpp "" "rows: no rounding slack of the square" 's/T\(1 \+ 8 \* kEps\)/T(1)/'
mutant splat_gaussian.h splat_rows_test.cpp "" "tiles: no rounding slack of the square" 's/bound = T\(1 \+ 8 \* kEps\) \* /bound = /'
mutant splat_gaussian.h splat_rows_test.cpp "" "tiles: no rounding slack of square and columns" 's/bound = T\(1 \+ 8 \* kEps\) \* /bound = /; s/kSlack \+ \(std::fabs\((right|left)\) \+ \1_root\) \* inv_a \* \(4 \* kEps\)/kSlack/'
mutant tile_lists.h prepared_cloud_test.cpp "" "radix sort: quarters interleaved" 's/f\(i \+ q \* quarter, q\);/f(kQuarters * i + q, q);/'
mutant tile_lists.h prepared_cloud_test.cpp "" "radix sort: remainder after the quarters dropped" 's/for \(std::uint32_t i = kQuarters \* quarter; i < count; \+\+i\) f\(i, kQuarters - 1\);//'
mutant splat_rows.h splat_rows_test.cpp "" "rows: first band for all bands" 's/band \* kBandPx, kBandPx, rows/0, kBandPx, rows/'
mutant splat_rows.h $t "tile_isa.cpp" "mean in float" 's/x_\[k\] = S\(g\.mean_x - W\(frame\.x_px \+ 0\.5\)\)/x_[k] = S(S(g.mean_x) - S(frame.x_px + 0.5))/'
mutant splat_step_kernels.h $t "tile_isa.cpp" "alpha of exactly 1\/255 left out" 's/exponent, L\(S\(kLog2AlphaMin\)\)\)/exponent, L(S(kLog2AlphaMin + 1e-6)))/'
mutant splat_step_kernels.h $t "tile_isa.cpp" "exponent as the printed form" 's/const L along = fma_lanes\(along_u, u, linear\);/const L two = L(typename LaneTraits<L>::Scalar(2));/; s/fma_lanes\(-along, along, constant\)/constant - linear * linear - two * along_u * u * linear - along_u * u * (along_u * u)/'
mutant $f $t "tile_isa.cpp" "weight without the transmittance" 's/const L weight = k\.alpha \* k\.transmittance;/const L weight = k.alpha;/'
f=splat_backward.h
mutant $f $t "tile_isa.cpp" "the cap passes a gradient" 's/select\(alpha < cap, weight \* difference, zero\)/weight * difference/'
mutant $f $t "tile_isa.cpp" "colour behind without the layers behind it" 's/behind_\[pack\] = fma_lanes\(alpha, difference, behind_\[pack\]\)/behind_[pack] = alpha * v/'
mutant $f $t "tile_isa.cpp" "no background behind the stack" 's/in_?\.background\[c\] : S\(0\)/S(0) : S(0)/'
mutant splat_gaussian.h $t "" "half extents halved" 's/half_width = sqrt\(reach2 \* p\.cov_xx\)/half_width = S(0.5) * sqrt(reach2 * p.cov_xx)/; s/half_height = sqrt\(reach2 \* p\.cov_yy\)/half_height = S(0.5) * sqrt(reach2 * p.cov_yy)/'

t=evidence_stability_test.cpp f=scene/evidence.cpp
mutant scene/evidence.h $t $f "squares of signals in double" 's/units \* units\}/std::uint64_t(double(units) * double(units))}/'
mutant $f $t $f "variance as a difference in double" 's/const Wide numerator = .*;/const double numerator = double(squares) * views - double(sum) * double(sum);/'
mutant $f $t $f "pixel counts in 32 bits" 's/pixels\[i\] \+= other\.pixels\[i\];/pixels[i] = std::uint32_t(pixels[i] + other.pixels[i]);/'
mutant $f $t $f "views not merged" 's/views\[i\] \+= other\.views\[i\];//'
mutant splat/evidence.cpp $t splat/evidence.cpp "unknown pixels counted" 's/of\.masks\.known\.empty\(\) \? nullptr : of\.masks\.known\.data\(\)/nullptr/'

t=metrics_test.cpp
mutant mask_pair.h $t "" "mask pairs: window of the rendered mask only" 's/at\.add\(box_where\(view_width_px, .*$//'
mutant mask_pair.h $t "" "mask pairs: band width from the window size" 's/band_width_px\(0\.02, view_width_px, view_height_px\)/band_width_px(0.02, width_px(), height_px())/'
t=splat/evidence_test.cpp
mutant evidence_tile.h $t tile_isa.cpp "evidence: visibility weights equal rendering weights" 's/if constexpr \(kByVisibility\) weight = weight \* hit\.transmittance;//'
mutant evidence_tile.h $t tile_isa.cpp "evidence: an object that covers a tile has no sums there" 's/== 1 \? at\[i\] : S\(0\)/== 1 ? S(0) : S(0)/'
mutant splat/evidence.cpp $t splat/evidence.cpp "evidence: only tiles whose first Gaussian is wanted" 's/std::any_of\(work\.visible, work\.visible \+ work\.entries,/std::any_of(work.visible, work.visible + std::min(work.entries, 1u),/'
t=geometry_stability_test.cpp
mutant sample_grid_kernels.h $t sample_grid.cpp "Gaussians behind the camera count" 's/if \(!\(t\.z > camera\.near_z\)\) return;//'
mutant sample_grid_kernels.h $t sample_grid.cpp "boxes thinner than a pixel divided" 's/if \(length < 1\) return .*;//'
mutant sample_grid_kernels.h $t sample_grid.cpp "box without visible Gaussians" 's/if \(sums\.visible == 0\) return \{\};//'
mutant sample_grid_kernels.h $t sample_grid.cpp "box not clipped" 's/max2\(b\.min_x - pad_px, 0\.0\)/b.min_x - pad_px/'
mutant ray_query_kernels.h $t ray_query.cpp "division by K - 1 = 0" 's/if \(samples == 1\) return .*;//'
mutant ray_query_kernels.h $t ray_query.cpp "window through the camera" 's/max2\(centre - half, nearest\)/centre - half/'
mutant ray_query_kernels.h $t ray_query.cpp "spacing divided by K - 1 = 0" 's/samples > 1 \? samples - 1 : 1/samples - 1/'
mutant ray_query_kernels.h $t ray_query.cpp "cosine from the other two components" 's/cosine = T\(1\) \/ sqrt\(x \* x \+ y \* y \+ T\(1\)\);/cosine = T(1) \/ sqrt(x * x + y * y + T(1)); cosine = sqrt(T(1) - cosine * cosine * (x * x + y * y));/'
mutant ray_query_kernels.h $t ray_query.cpp "depth divided by no alpha" 's/if \(!\(covered > least_alpha\)\) return 0;//'
mutant pixel_grid.h $t ray_query.cpp "positions beyond the border not clamped" 's/const double at = clamp3\(position_px - 0\.5, 0\.0, double\(size_px - 1\)\);/const double at = position_px - 0.5 < 0 ? 0 : position_px - 0.5;/'

t=neighbours_stability_test.cpp
mutant knn.cpp knn_test.cpp knn.cpp "ties in any order" 's/dist2 < o\.dist2 \|\| \(dist2 == o\.dist2 \&\& index < o\.index\)/dist2 <= o.dist2/'
mutant knn.cpp knn_test.cpp knn.cpp "ties not admitted" 's/std::nextafter\((best_\[count_ - 1\]\.dist2), .*\);/\1;/'
mutant knn.cpp knn_test.cpp knn.cpp "a point is its own neighbour" 's/index == excluded_ \|\| //'
mutant knn.cpp knn_test.cpp knn.cpp "within: a tie is outside" 's/admitted_\(std::nextafter\(most_dist2, kInfinity\)\)/admitted_(most_dist2)/'
mutant knn.cpp knn_test.cpp knn.cpp "within: a tie with the box is outside" 's/box\.dist2\(query\) > radius/box.dist2(query) >= radius/'
mutant knn.cpp knn_test.cpp knn.cpp "within: inactive queries are searched" 's/if \(!active\.empty\(\) .* continue;//'
mutant knn.cpp $t knn.cpp "search in float" 's/return \{rows\.data, rows\.data \+ rows\.n \* 3\};/std::vector<double> out; for (std::int64_t i = 0; i < rows.n * 3; ++i) out.push_back(double(_Float16(rows.data[i]))); return out;/'
f=rbf_kernels.h
mutant $f $t "" "rounding gives the farther neighbour a larger weight" 's/max2\((dot\(x0 - xj, .*\)), T\(0\)\)/\1/'
mutant $f $t rbf.cpp "nearest distance not subtracted" 's/dot\(x0 - xj, \(q - x0\) \+ \(q - xj\)\)/dot(q - xj, q - xj)/'
mutant $f $t rbf.cpp "d_j² - d_0² as a difference" 's/dot\(x0 - xj, \(q - x0\) \+ \(q - xj\)\)/dot(q - xj, q - xj) - dot(q - x0, q - x0)/'
mutant $f $t rbf.cpp "1e-6 added to the sum" 's/w\[j\] = w\[j\] \/ sum;/w[j] = w[j] \/ (sum + T(1e-6));/'
mutant rbf.cpp $t rbf.cpp "1 \/ 2h² overflows" 's/float\(std::min\((1\.0 \/ \(2\.0 \* width \* width\)), .*\)\);/float(\1);/'
mutant rbf.cpp $t rbf.cpp "width 0 where points coincide" 's/spacing > 0 \? factor \* spacing : 1\.0/factor * spacing/'

t=encoding_stability_test.cpp f=hash_grid_kernels.h
mutant $f $t hash_grid.cpp "coordinates not clamped" 's/clamp3\(unit, T\(0\), T\(1\)\)/unit/'
mutant $f $t hash_grid.cpp "origin subtracted after scaling" 's/\(world - centre\) \* inv_extent/(world * inv_extent - centre * inv_extent)/'
mutant $f $t hash_grid.cpp "no half-cell stagger" 's/\* scale \+ T\(0\.5\)/* scale/'
mutant hash_grid.cpp $t hash_grid.cpp "division by no extent" 's/side > 0 \? float\(1 \/ side\) : 0\.f/float(1 \/ side)/'
mutant hash_grid.cpp $t hash_grid.cpp "resolution³ in 32 bits" 's/std::uint64_t\(level\.resolution\) \* level/level.resolution * level/'
f=film_mlp_kernels.h
mutant $f $t "" "ReLU hides NaN" 's/select\(x < L\(S\(0\)\), L\(S\(0\)\), x\)/select(x > L(S(0)), x, L(S(0)))/'
mutant $f $t "" "colour gradient as y (1 - y)" 's/sigmoid_slope\((raw\[\(1 \+ ch\) \* kColumns \+ q\])\)/(sigmoid(\1) * (S(1) - sigmoid(\1)))/'
mutant $f $t "" "density as log(1 + e^x)" 's/softplus\(raw\[q\]\)/std::log(S(1) + std::exp(raw[q]))/'
mutant $f $t "" "modulation without its offset" 's/fma_lanes\(load\(gamma \+ i\), load\(h \+ i\), load\(beta \+ i\)\)/load(gamma + i) * load(h + i)/'
mutant film_gemm_kernels.h $t "" "bias dropped" 's/bias \? bias\[r\] : S\(0\)/S(0)/'

t=volume_stability_test.cpp f=volume_kernels.h
mutant $f $t "" "weights as T_k - T_k+1" 's/weight\[at\] = transmittance \* one_minus_exp\(tau\);/weight[at] = transmittance - exp_of(-(depth + tau));/'
mutant $f $t "" "alpha as 1 - e^-D" 's/alpha\[r\] = one_minus_exp\(depth\);/alpha[r] = T(1) - exp_of(-depth);/'
mutant $f $t "" "transmittance as a product of 1 - α" 's/transmittance = exp_of\(-depth\);/transmittance = transmittance * (T(1) - one_minus_exp(tau));/'
mutant $f $t "" "no background behind the ray" 's/T behind = end \* dot\(g, in\.background\);/T behind = T(0);/'
mutant $f "$t volume_grad_test.cpp" "" "suffix sum includes the sample" 's/(grad_density\[at\] = .*)behind \+ common/\1behind - weight[at] * along + common/'
mutant loss_mask_kernels.h $t loss_mask.cpp "0 times an overflowed depth" 's/min2\(double\(depth\), 0x1\.fffffep127\)/double(depth)/'

t=losses_stability_test.cpp f=loss_mask_kernels.h
mutant $f $t loss_mask.cpp "log(1 - p)" 's/log1p_of\(-at\)/log(rest)/'
mutant $f $t loss_mask.cpp "clamp instead of the tangent" 's/ \+ slope \* \(p - at\)//'
mutant $f $t loss_mask.cpp "prediction not clamped" 's/at = clamp3\(p, low, T\(1\) - low\)/at = p/'
mutant $f $t loss_mask.cpp "unknown pixels have a loss" 's/if \(counts\) loss =/loss =/'
mutant loss_mask.cpp $t loss_mask.cpp "float accumulator" 's/loss\.total \+= sum;/loss.total = float(loss.total) + float(sum);/'
mutant loss_mask.cpp $t loss_mask.cpp "mean over no pixels" 's/if \(loss\.known == 0\) return none\(loss\);//'
f=loss_align_kernels.h
mutant $f $t loss_align.cpp "E[x²] - E[x]²" 's/const Vec3<T> d = vec3\(image\.at\(x, y, 3\)\) - mean;/const Vec3<T> d = vec3(image.at(x, y, 3));/; s/return share \* variance;/return share * variance - dot(mean, mean);/'
mutant $f $t loss_align.cpp "mean of the sum, not of the patch" 's/mean = share \* mean;//'
mutant $f $t loss_align.cpp "inactive nodes count" 's/if \(in\.is_active\(r\)\)/if (true)/'
mutant loss_align.cpp $t loss_align.cpp "mean over no nodes" 's/if \(loss\.nodes == 0\) return(.*);/if (false) return\1;/'
f=loss_cont_kernels.h
mutant $f $t loss_cont.cpp "|a|² - 2 a·b + |b|²" 's/dot\(d, d\)/(dot(here, here) - T(2) * dot(here, here - d) + dot(here - d, here - d))/'
mutant $f "$t loss_cont_grad_test.cpp" loss_cont.cpp "edges that point here forgotten" 's/at < graph\.row_begin\[i \+ 1\]/at < graph.row_begin[i]/'
mutant $f $t loss_cont.cpp "weights of edges not normalised" 's/T\(1\) \/ T\(index\.c\)/T(2)/'
mutant loss_cont.cpp $t loss_cont.cpp "mean over no neighbours" 's/^    return 0;$/    return 0.0 \/ graph.neighbours;/'
f=loss_smooth_kernels.h
mutant $f $t loss_smooth.cpp "|a|² - 2 a·b + |b|²" 's/term\[i\] = dot\(d, d\);/const Vec3<T> a = vec3(colour.row(i)), b = a + d; term[i] = dot(a, a) - T(2) * dot(a, b) + dot(b, b);/'
mutant $f "$t loss_smooth_grad_test.cpp" loss_smooth.cpp "sign of one gradient" 's/back\[0\] = -g\.x/back[0] = g.x/'
mutant loss_smooth.cpp $t loss_smooth.cpp "the factor 3 of the estimate" 's/3 \* ratio \* ratio/ratio * ratio/'
f=photometric_kernels.h
mutant $f photometric_test.cpp photometric_impl.cpp "SSIM with a variance below 0" 's/max_lanes\((moment\[kSquares\] - means), L\(T\(0\)\)\)/(\1)/'
mutant $f $t "" "C2 dropped" 's/ \+ L\(T\(kC2\)\)//'
mutant $f $t "" "C1 dropped" 's/ \+ L\(T\(kC1\)\)//'
mutant $f $t "" "covariance not doubled" 's/a2 = two \* \(moment/a2 = (moment/'
mutant photometric_strips.h photometric_test.cpp photometric_impl.cpp "padding not cleared" 's/clear_padding\(layout, .*\);/continue;/'

t=optimiser_stability_test.cpp f=adam.cpp
mutant adam_kernels.h $t $f "no eps" 's/ \* inv_root \+ eps\)/ * inv_root)/'
mutant adam_kernels.h $t $f "rows without a gradient decay" 's/if \(touched\)/if (true)/'
mutant adam_kernels.h $t $f "first moment not moved by its share" 's/m\[i\] = mi;/m[i] = g;/'
mutant $f $t $f "1 - β₂ in float" 's/T\(1\.0 - o\.beta2\)/T(1) - T(o.beta2)/'
mutant adam_kernels.h $t $f "1 - β₂^t in float" 's/-std::expm1\(double\(step\) \* std::log\(beta\)\)/double(1 - std::pow(float(beta), float(step)))/'
mutant $f $t $f "NaN passes the check" 's/if \(!\(std::abs\(values\[std::size_t\(i\)\]\) <= limit\)\)/if (std::abs(values[std::size_t(i)]) > limit)/'
f=label_solve.cpp
mutant $f $t $f "0 \/ 0 of a label without evidence" 's/object \+ rest > 0 \? (object \/ \(object \+ rest\)) : m\[i\]/\1/'
mutant $f $t $f "what is left as 1 - rest" 's/\? object \/ \(object \+ rest\)/? 1 - rest \/ (object + rest)/'
mutant $f $t $f "gap of one bound only" 's/gap \+= std::max\(g \* m\[i\], .*;/gap += g * m[i];/'

t=joint_grad_test.cpp
mutant row_kernels.h $t continuity_loss.cpp "colour continuity without its gradient" 's/\+= float\(kShC0 \* /+= float(0 * /'
f=mask_loss.cpp
mutant $f $t $f "mask loss without its weight" 's/weight_, \&gradient/1.0, \&gradient/'
mutant row_kernels.h $t trained_labels.cpp "label gradient without the sigmoid" 's/ \* sigmoid_slope\(cells\.logit\[c\]\)//'
f=field_losses.cpp
mutant $f $t $f "smoothness gradient doubled" 's/positions\(\), weights_\.smooth/positions(), 2 * weights_.smooth/'

t="contour_refine_test.cpp alignment_stability_test.cpp" f=contour_refine.cpp
mutant $f "$t" $f "densities of colours without a least variance" 's/\(i == j \? kColourNoise : 0\.0\)/0.0/; s/std::max\(root_\[i\]\[i\], 0\.5 \* kColourNoise\)/root_[i][i]/'
mutant $f "$t" $f "contour refinement: equal weights of all neighbours" 's/std::exp\(-squared_difference\(colour\[p\], colour\[q\]\) \/ mean_square\)/1.0/'
mutant $f "$t" $f "contour refinement: mean colour step along x only" 's/if \(y \+ 1 < win\.h\) sum .*//'
mutant $f "$t" $f "contour refinement: neighbours outside the band ignored" 's/system\.right\[std::size_t\(row\)\] \+= w \* double\(system\.given\[q\]\);/;/'
mutant $f "$t" $f "contour refinement: no prior at the given contour" 's/shape_weight \* system\.shape\.back\(\)/0/'
mutant $f "$t" $f "contour refinement: non-finite colours in the means" 's/if \(std::isfinite\(v\)\) \{/{/'
t="pose_step_test.cpp alignment_stability_test.cpp" f=pose_step.cpp
mutant $f "$t" $f "no prior on the motion" 's/const double prior = .*;/const double prior = 0;/'
mutant $f "$t" $f "pose step: exposure not matched" 's/match_exposure\(photo, pixels, from\);//'
mutant $f "$t" $f "pose step: no Cauchy weights" 's/return 1 \/ \(1 \+ residual .*;/return 1 + 0 * residual;/'
t="optimisers_test.cpp alignment_stability_test.cpp" f=anderson.cpp
mutant $f "$t" $f "no ridge" 's/1 \+ kRidge/1/'
mutant $f "$t" $f "weights ignored" 's/sum \+= w\[i\] \* a\[i\]/sum += a[i]/'
mutant $f "$t" $f "combined step without the points' differences" 's/dx_\[std::size_t\(j\)\]\[i\] \+ df_/df_/'
t=label_solve_test.cpp f=label_evaluate.cpp
mutant $f $t $f "label sums: background of a pixel from m" 's/c = fma_lanes\(weight, rest, c\)/c = fma_lanes(weight, m, c)/'
mutant $f $t $f "label sums: factors of binary targets swapped" 's/select\(inside > L\(0\.f\), m, rest\)/select(inside > L(0.f), rest, m)/'
mutant $f $t $f "label sums: outside sums skipped in packs that cross the mask" 's/accumulate\(sums\.outside\.data\(\), f\.c\)/any(f.q > L(0.f)) ? void() : accumulate(sums.outside.data(), f.c)/'
mutant $f $t $f "label sums: the first band twice" 's/\(inside\[at\] \+ inside\[at \+ 1\]\)/(inside[at] + inside[at])/'
f=label_packs.h g="label_evaluate.cpp label_collect.cpp"
mutant $f $t "$g" "label sums: unknown pixels count as background" 's/select\(p\.inside \+ p\.outside > L\(0\.f\), factor, L\(1\.f\)\)/factor/'
mutant $f $t "$g" "label sums: predictions of exactly 0" 's/return fma_lanes\(L\(float\(1 - 2 \* kMaskEps\)\), sum, .*;/return sum;/'
f=label_collect.cpp
mutant $f $t $f "label sums: folded Gaussians ignored" 's/foreground\[k\] = fma_lanes\(weight, m, foreground\[k\]\)/foreground[k] = foreground[k]/'
mutant $f $t $f "label sums: long steps cut off" 's/for \(; place - last_ > kMaxByteStep; .*$//'
t=metrics_test.cpp f=metrics.cpp
mutant $f $t $f "band without its last pixel" 's/<= band_px/< band_px/g'
mutant $f $t $f "score of two empty masks is 0" 's/whole == 0 \? if_nothing/whole == 0 ? 0/'
mutant $f $t $f "union of the bands from one mask" 's/in_any \+= p \|\| t/in_any += p/'
t=front_layer_test.cpp f=front_layer.cpp
mutant $f $t $f "front layer: weight without the transmittance" 's/hit\.alpha \* hit\.transmittance, L/hit.alpha, L/'
mutant $f $t $f "front layer: every Gaussian is a candidate" 's/is_candidate = candidate.*;/is_candidate = true;/'
mutant $f $t $f "front layer: depths not compared" 's/select\(L\(depth\) < limit\[hit\.pack\], /select(L(depth) < L(1e30f), /'

t=pictures_stability_test.cpp
mutant $f $t $f "a surface at a Gaussian lies behind it" 's/L\(depth\) < limit\[hit\.pack\]/limit[hit.pack] >= L(depth)/'
mutant median.h $t "" "a third instead of the middle" 's/values\.size\(\) \/ 2/values.size() \/ 3/'
f=metrics.cpp
mutant $f $t $f "squares, not the square of the difference" 's/sum \+= w \* d \* d;/const float p = a.at(x, int(y), c), q = b.at(x, int(y), c); sum += w * double(p * p - 2 * p * q + q * q) + 0 * d;/'

t="emulated.cpp emulated_main.cpp backends.cpp splat_parity.cpp" f=tiles_kernel.h
mutant $f "$t" "" "device: pairs of a Gaussian in one row of tiles only" 's/ty < rect\[i\]\.y_end/ty < rect[i].y_begin + 1/'
mutant $f "$t" "" "device: last tile without an end" 's/if \(i <= tiles\)/if (i < tiles)/'
mutant $f "$t" "" "device: keys sorted by tile only" 's/\| near_first;/| 0;/'
mutant $f "$t" "" "device: columns of a tile added in another order" 's/sum\[x\] \+= sum\[x \+ half\];/sum[x] += sum[2 * half - 1 - x];/'
mutant $f "$t" "" "device: a warp without its last row" 's/reached\.begin < first \+ kWarpRows/reached.begin < first + kWarpRows - 1/'
mutant $f "$t" "" "device: rows of the other band" 's/rows\[warp % kBands\]/rows[(warp + 1) % kBands]/'
mutant $f "$t" "" "device: reached by the Gaussians of another chunk" 's/\[first \+ k\]/[k]/'
mutant $f "$t" "" "device: a warp of two rows of the tile" 's/column\(thread .*kBandPx\),/column(thread % kTilePx),/; s/row\(thread .*kBandPx\),/row(thread \/ kTilePx),/'
f=splat_forward_kernel.h
mutant $f "$t" "" "device: a batch of the whole tile" 's/min2<std::int64_t>\(kStaged, end - first\)/kStaged/'
mutant $f "$t" "" "device: background behind an opaque tile" 's/fma_lanes\(own\.traversal\.transmittance, channels\.background\[c\], own\.sum\[c\]\)/own.sum[c]/'
mutant $f device_kernels_test.cpp "" "device: checkpoints stored by the wrong tile" 's/return begin \/ kEntries \+ tile;/return begin \/ kEntries;/'
mutant $f "$t" "" "device: checkpoints of pixels that have stopped" 's/own\.traversal\.live \? own\.traversal\.transmittance : -1\.f/own.traversal.transmittance/'
f=splat_backward_kernel.h
mutant $f "$t" "" "device: no barrier before memory is used again" 's/if \(j < used\) sum_column\(shared, (.*), own\.part\);/if (j < used) { sum_column(shared, \1, own.part); for (int k = 0; k < kSums; ++k) shared.column[t % kTilePx][j * kSums + k] = own.part[k]; }/'
mutant $f "$t" "" "device: chunks from the near end" 's/for \(int from = min2.*; \(from -= kChunk\) >= 0;\)/for (int from = 0; from < min2(kStaged, chunks * kChunk - first); from += kChunk)/'
mutant $f "$t" "" "device: Gaussians of a chunk from the near end" 's/highest_bit\(left\)/lowest_bit(left)/'
mutant $f "$t" "" "device: the nearest chunk left out" 's/\(from -= kChunk\) >= 0/(from -= kChunk) > 0/'
mutant $f "$t" "" "device: geometry of channel groups not added" 's/channels\.first > 0 \? \*to \+ value : value/false ? value : value/'
mutant $f "$t" "" "device: pixels of another column" 's/at = pixel_place\(x, row\), place/at = pixel_place(row, x), place/'
mutant $f "$t" "" "device: an atomic sum without its last column" 's/if \(sums == DeviceSums::kAtomic\)$/if (sums == DeviceSums::kAtomic \&\& k + 1 < kPairGeometry + channels.used)/'
mutant splat_kernel.h "$t" "" "device: rows of pairs read as sums" 's/rows = std::move\(sum\);//'
mutant evidence_kernel.h "$t" "" "device: evidence of a column from below" 's/for \(int row = rows\.begin; row < rows\.end; \+\+row\) \{/for (int row = rows.end; row-- > rows.begin;) {/'
mutant evidence_kernel.h "$t" "" "device: second group of objects over the first" 's/k \+ 2 \* first\)\]/k)]/'
t="emulated.cpp emulated_main.cpp backends.cpp splat_parity.cpp"
mutant splat_forward_kernel.h "$t" "" "device: a layer also behind its surface" 's/weight = shared.*own\.limit \? weight : 0\.f;/weight += 0.f;/'
mutant evidence_kernel.h "$t" "" "device: sums also behind the surface" 's/weight = shared.*own\.limit \? weight : 0\.f;/weight += 0.f;/'
mutant splat_forward_kernel.h "$t" "" "device: a layer of all Gaussians" 's/to\[columns\] = candidate\[i\] \? 1\.f : 0\.f;/to[columns] = 1.f;/'
t="emulated.cpp emulated_main.cpp backends.cpp field_parity.cpp"
mutant knn_kernel.h "$t" "" "device: equal distances lose their order" 's/if \(!placed \&\& !/if (!/'
mutant knn_kernel.h "$t" "" "device: float distances rejected without slack" 's/ \* 1\.000002f;/ * 0.999f;/'
mutant hash_grid_kernel.h "$t" "" "device: every contribution starts a sum" 's/if \(i > 0 \&\& key\[i - 1\] == key\[i\]\) return;//'
mutant hash_grid_kernel.h "$t" "" "device: an atomic sum drops a contribution" 's/(\[\]\(float\* to, float x\) \{ )(Launcher::atomic_add)/[i](float* to, float x) { if (i != 77) \2/'
mutant film_backward_kernel.h "$t" "" "device: parts lose the last tile" 's/\(block\.index \+ 1\) \* tiles \/ kParts;/(block.index + 1) * tiles \/ kParts - 1;/'
mutant film_backward_kernel.h "$t" "" "device: conditions not loaded again" 's/Tile::load_condition\(t, net, first, shared\.condition\);//'
mutant film_forward_kernel.h "$t" "" "device: activations written while they are read" 's/(Tile::product\(t, .*, shared\.x, own\.cells\);)/\1 shared.x[t] = own.cells[0][0];/'
t="emulated.cpp emulated_main.cpp backends.cpp loss_parity.cpp"
mutant sum_kernel.h "$t" "" "device: a chunk one short" 's/row < rows\.end; row \+= rows\.step\)$/row + rows.step < rows.end; row += rows.step)/'
mutant photometric_kernel.h "$t" "" "device: pixels outside the image in the window" 's/px >= 0 \&\& px < layout\.w \&\& line/px >= 0 \&\& line/'
mutant adam_kernel.h "$t" "" "device: negative overflow passes" 's/if \(!\(value <= limit \&\& -value <= limit\)\)/if (!(value <= limit))/'
mutant adam_kernel.h "$t" "" "device: the last unusable gradient found" 's/found = i < found \? i : found;/found = i;/'

t=window_input_test.cpp
mutant pixel_window.cpp $t pixel_window.cpp "windows not aligned to the tiles" 's/ \/ kGrain_px \* kGrain_px; \};/ + 1; };/'

t=cached_view_test.cpp f=cached_view.cpp
mutant $f $t "$f" "cached view: pixels that leave the mask are ignored" 's/target\[p\] == float\(mask\[p\]\)/target[p] >= float(mask[p])/'
mutant $f $t "$f" "cached view: sums are computed only once" 's/if \(!changed\[v\]\) continue;/if (changed[v] \&\& s.sums.weight(s.place[v]) > 0) continue;/'

t=leave_one_out_test.cpp f=leave_one_out.cpp
mutant exact_sum.h $t $f "exact sum: subtraction below zero is not clamped" 's/    if \(whole < other\.whole .*return void\(\*this = \{\}\);//'

t=sparse_table_test.cpp f=sparse_table.h
mutant $f $t $f "sparse table: deferred inserts are lost" 's/touch\(insert\.row, insert\.column\)\.add\(insert\.cell\)/touch(insert.row, insert.column)/'
mutant $f $t "" "sparse table: cells of a row in the order of touching" 's/while \(\*at != kNone && node_\[\*at\]\.column < column\) at = .*;//'
mutant $f $t "" "sparse table: duplicate cells" 's/if \(\*at == kNone \|\| node_\[\*at\]\.column != column\)/if (true)/'
mutant $f $t "" "sparse table: the next cell for a missing one" 's/at != kNone && node_\[at\]\.column == column \?/at != kNone ?/'
t=cull_test.cpp
mutant binned_view.h $t "" "tiles_touching: untouched tiles are rasterised" 's/lists\.last_z = last_needed_z\(.*\);/lists.last_z.clear();/'
mutant tile_lists.h $t "" "tiles_touching: spans of the first rows only" 's/row < kFirstRows \? view\.first\[v\]\[std::size_t\(row\)\] : tile_span\(.*\);/row < kFirstRows ? view.first[v][std::size_t(row)] : TileSpan{0, 0};/'
mutant splat_gaussian.h $t "" "culling: rectangle too narrow on the right" 's/kTilePx \* drawn\.x_end \* z/kTilePx * (drawn.x_end - 9) * z/'
mutant project_block.cpp $t project_block.cpp "max_depth: a block is culled by its farthest corner" 's/float\(z_least\) < view_\.far_z/float(z_most) < view_.far_z/'
mutant tile_lists.h $t "" "stop_after: a tile stops at any flagged Gaussian" 's/row\[tx\] = std::max\(row\[tx\], double\(view\.depth\[v\]\)\)/row[tx] = double(view.depth[v])/'
mutant tile_lists.h $t "" "stop_after: the last flagged Gaussian is culled" 's/if \(depth <= lists_\.last_z/if (depth < lists_.last_z/'
mutant binned_view.h $t "" "stop_after: tiles of faint labels are rasterised" 's/reached\[tile\] > 0 \? last\[tile\] : 0/last[tile]/'
mutant prepared_cloud.cpp prepared_cloud_test.cpp prepared_cloud.cpp "groups: bounds not updated for moved rows" '/if \(changed\[std::size_t\(block\)\]\)/,/^}/s/bound_groups\(\);//'
mutant splat/evidence.cpp splat/evidence_test.cpp splat/evidence.cpp "evidence of selected Gaussians: rows instead of numbers" 's/wanted_ \? wanted_->number\[id\[v\]\] : id\[v\]/id[v]/'
mutant curve_blocks.cpp prepared_cloud_test.cpp curve_blocks.cpp "curve: chunks overwrite each other" 's/for \(std::size_t c = 0; c < chunks_; \+\+c\) at \+= std::exchange\(next\[c \* kParts \+ p\], at\);/for (std::size_t c = 0; c < chunks_; ++c) at += std::exchange(next[c * kParts + p], part_begin_.back());/'
