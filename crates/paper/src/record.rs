//! What lies in the directory of an earlier run, and whether it still is what would be computed now.

use super::product::Product;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use twinslip_tasks::scene::shipped;

/// The file that holds it.
pub const FILE: &str = "manifest.json";

/// All that was made, by product.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Seconds by the clock that the last run took which made something.
    pub seconds: Option<f64>,
    /// What made it.
    pub machine: BTreeMap<String, String>,
    /// By the product's name.
    pub products: BTreeMap<String, ProductEntry>,
}

/// One product.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ProductEntry {
    /// Scenes, program and numerics in one number: where it differs, the product is out of date.
    pub key: String,
    /// How it was computed.
    pub method: String,
    /// Seconds of processor time that it took, its pieces included, also those that other products show too.
    pub seconds: f64,
    /// Its files.
    pub files: Vec<Written>,
}

/// One file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Written {
    /// Its name in the directory.
    pub name: String,
    /// Its length.
    pub bytes: u64,
    /// Its SHA-256.
    pub sha256: String,
}

impl Written {
    /// Of these bytes.
    pub fn new(name: impl Into<String>, bytes: &[u8]) -> Self {
        Written {
            name: name.into(),
            bytes: bytes.len() as u64,
            sha256: hash(bytes),
        }
    }

    /// Whether the file is there, to the byte.
    pub fn stands(&self, dir: &Path) -> bool {
        let path = dir.join(&self.name);
        let length = fs::metadata(&path).map(|data| data.len());
        length.is_ok_and(|length| length == self.bytes)
            && fs::read(&path).is_ok_and(|bytes| hash(&bytes) == self.sha256)
    }
}

impl Record {
    /// That of a directory; nothing where there is none, or none that can be read.
    pub fn read(dir: &Path) -> Self {
        let text = fs::read(dir.join(FILE)).unwrap_or_default();
        serde_json::from_slice(&text).unwrap_or_default()
    }

    /// As it is written.
    pub fn bytes(&self) -> Vec<u8> {
        let mut bytes = serde_json::to_vec_pretty(self).expect("names and numbers can be written");
        bytes.push(b'\n');
        bytes
    }

    /// Whether a product stands as it would be made now.
    pub fn current(&self, product: &Product, key: &str, png: bool, dir: &Path) -> bool {
        self.products.get(product.id).is_some_and(|entry| {
            let named = |name: &String| entry.files.iter().find(|file| file.name == *name);
            let stands = |name: &String| named(name).is_some_and(|file| file.stands(dir));
            entry.key == key && product.files(png).iter().all(stands)
        })
    }
}

/// The key of a product: the texts of its scenes, and the program that reads them. Numerics that no scene sets are the
/// program's.
pub fn key(product: &Product, program: &str) -> String {
    let mut hasher = Sha256::new();
    let mut take = |text: &str| {
        hasher.update((text.len() as u64).to_le_bytes());
        hasher.update(text.as_bytes());
    };
    take(program);
    take(product.id);
    for scene in product.scenes {
        take(scene);
        take(shipped(scene).unwrap_or_default());
    }
    hex(&hasher.finalize())
}

/// The SHA-256 of bytes, in hexadecimal digits.
pub fn hash(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
