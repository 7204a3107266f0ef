//! What made the report, and the files beside it with their hashes: what one needs to repeat it and to compare.

use super::FileRow;
use super::words::{grouped, link};
use maud::{Markup, html};

/// The section of both.
pub fn section(manifest: &[(String, String)], files: &[FileRow]) -> Markup {
    html! {
        section #provenance aria-labelledby="provenance-title" {
            h2 #provenance-title { "How to repeat it" }
            p {
                "The manifest names what made this report, the hashes identify the files beside it: "
                "run the same version again and compare. The last digits depend on the vector instructions, "
                "which the manifest names: on a processor that has more of them, hold it to the same by the "
                "environment variable " code { "TWINSLIP_VECTORS" } " (" code { "avx512" } ", " code { "avx2" }
                " or " code { "none" } "), and compare on the same system and with the same C library, whose "
                "functions the start of some runs takes."
            }
            @if !manifest.is_empty() {
                details {
                    summary { "Manifest" }
                    div.scroll role="region" aria-label="Manifest" tabindex="0" {
                        table.manifest {
                            caption { "What made this report" }
                            tbody { @for (name, value) in manifest { tr { th scope="row" { (name) } td { (value) } } } }
                        }
                    }
                }
            }
            @if !files.is_empty() {
                details {
                    summary { "Files and their hashes (" (files.len()) ")" }
                    div.scroll role="region" aria-label="Files and their hashes" tabindex="0" {
                        table.files {
                            caption { "The files beside this report" }
                            thead {
                                tr {
                                    th scope="col" { "File" }
                                    th scope="col" { "Bytes" }
                                    th scope="col" { "SHA-256" }
                                }
                            }
                            tbody { @for file in files { (row(file)) } }
                        }
                    }
                }
            }
        }
    }
}

fn row(file: &FileRow) -> Markup {
    html! {
        tr {
            th scope="row" { (link(&file.name)) }
            td.value { (grouped(file.bytes)) }
            td.hash { code { (file.sha256) } }
        }
    }
}
