//! Matrix products for wasm, where the gemm crate's only kernel is not vectorized. Native builds use dfdx's products.
//!
//! In: row-major matrices; the left one may be transposed. Out: their product. The loops run over blocks that fit into the
//! registers, and the compiler vectorizes them (`simd128`, see `web/build`).

/// The number of rows of a block of the result.
const ROWS: usize = 4;
/// The number of columns of a block of the result.
const COLUMNS: usize = 16;

/// The left factor of a product. Its strides can describe a transposed matrix, without a copy.
#[derive(Clone, Copy)]
pub(crate) struct LeftMatrix<'a> {
    pub(crate) values: &'a [f32],
    /// The distances in `values` from one row to the next, and from one column to the next.
    pub(crate) strides: (usize, usize),
}

/// `out` = `left` (m x k) times `right` (k x n, row-major); m x n, row-major.
pub(crate) fn multiply(
    left: LeftMatrix<'_>,
    right: &[f32],
    (m, k, n): (usize, usize, usize),
    out: &mut [f32],
) {
    // A contiguous copy of the current columns of `right`, padded with zeros to the full width of a block.
    let mut strip = vec![[0.0; COLUMNS]; k];
    for column in (0..n).step_by(COLUMNS) {
        let width = COLUMNS.min(n - column);
        for (packed, row) in strip.iter_mut().zip(right.chunks_exact(n)) {
            packed[..width].copy_from_slice(&row[column..column + width]);
            packed[width..].fill(0.0);
        }
        let mut row = 0;
        while row < m {
            let height = ROWS.min(m - row);
            // If there are enough rows, the last block overlaps the previous one instead of being smaller.
            let first = if height < ROWS && m >= ROWS { m - ROWS } else { row };
            let mut write = |i: usize, sums: &[f32; COLUMNS]| {
                let at = (first + i) * n + column;
                out[at..at + width].copy_from_slice(&sums[..width]);
            };
            if first + ROWS <= m {
                block::<ROWS>(left, first, &strip).iter().enumerate().for_each(|(i, sums)| write(i, sums));
            } else {
                for i in 0..height {
                    write(i, &block::<1>(left, first + i, &strip)[0]);
                }
            }
            row += ROWS;
        }
    }
}

/// A block of the result: `HEIGHT` rows from row `first` on, in the columns of `strip`.
#[inline(always)]
fn block<const HEIGHT: usize>(
    left: LeftMatrix<'_>,
    first: usize,
    strip: &[[f32; COLUMNS]],
) -> [[f32; COLUMNS]; HEIGHT] {
    let (row_stride, column_stride) = left.strides;
    let mut sums = [[0.0; COLUMNS]; HEIGHT];
    for (p, right) in strip.iter().enumerate() {
        for (i, sums) in sums.iter_mut().enumerate() {
            let factor = left.values[(first + i) * row_stride + p * column_stride];
            for (sum, right) in sums.iter_mut().zip(right) {
                *sum += factor * right;
            }
        }
    }
    sums
}

/// The transpose of a matrix (rows x columns, row-major).
pub(crate) fn transposed(values: &[f32], rows: usize, columns: usize) -> Vec<f32> {
    let mut out = Vec::with_capacity(values.len());
    for column in 0..columns {
        out.extend((0..rows).map(|row| values[row * columns + column]));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_of_any_size_match_the_definition() {
        let value = |k: usize| ((k * 2_654_435_761) % 1000) as f32 / 500.0 - 1.0;
        for (m, k, n) in
            [(1, 1, 1), (1, 28, 64), (3, 5, 7), (4, 16, 16), (5, 17, 33), (64, 28, 64), (66, 64, 6)]
        {
            let a: Vec<f32> = (0..m * k).map(value).collect();
            let b: Vec<f32> = (0..k * n).map(|i| value(i + 7)).collect();
            let expected: Vec<f32> = (0..m * n)
                .map(|at| (0..k).fold(0.0, |sum, p| sum + a[at / n * k + p] * b[p * n + at % n]))
                .collect();
            let mut out = vec![f32::NAN; m * n];
            multiply(LeftMatrix { values: &a, strides: (k, 1) }, &b, (m, k, n), &mut out);
            assert_eq!(out, expected, "{m} x {k} x {n}");
            let left_transposed = transposed(&a, m, k);
            out.fill(f32::NAN);
            multiply(LeftMatrix { values: &left_transposed, strides: (1, m) }, &b, (m, k, n), &mut out);
            assert_eq!(out, expected, "{m} x {k} x {n}, with a transposed left matrix");
        }
    }
}
