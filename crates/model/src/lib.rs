//! What [afmsweep](https://docs.rs/afmsweep) sweeps: the [`scene`] as the user wrote it, and of its cases the
//! [`instrument`] (modes and free motion) and the [`contact`] (laws in closed forms).

pub mod contact;
pub mod instrument;
mod legendre;
pub mod matrix_product;
pub mod scene;

use afmsweep_data::{design, observe, suggestion, units};
use afmsweep_kernel as kernel;
