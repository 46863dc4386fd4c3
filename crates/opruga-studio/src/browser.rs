//! The services of a browser: its clock, its address, downloads and files.

use crate::report::Report;
use js_sys::{Array, Promise, Uint8Array};
use std::sync::mpsc::{Receiver, channel};
use wasm_bindgen::prelude::*;
use wasm_bindgen::{JsCast, JsValue};
use wasm_bindgen_futures::JsFuture;

/// A file that the user has chosen: its name and its bytes.
pub(crate) type Chosen = Result<(String, Vec<u8>), Report>;

fn window() -> Option<web_sys::Window> {
    web_sys::window()
}

/// Milliseconds since the page was opened.
pub(crate) fn milliseconds() -> f64 {
    window().and_then(|window| window.performance()).map_or(0.0, |clock| clock.now())
}

/// Returns after the browser has handled pending work: events, and the next picture if it is due.
pub(crate) async fn next_turn() {
    let promise = Promise::new(&mut |resolve, _| {
        if let Some(window) = window() {
            let _ = window.set_timeout_with_callback_and_timeout_and_arguments_0(&resolve, 0);
        }
    });
    // A timer cannot fail.
    let _ = JsFuture::from(promise).await;
}

/// Reports to the page that the graphics device was lost.
pub(crate) fn report_lost_device() {
    let event = web_sys::Event::new("opruga-device-lost");
    if let (Some(window), Ok(event)) = (window(), event) {
        let _ = window.dispatch_event(&event);
    }
}

/// The part of the address after its `#`.
pub(crate) fn fragment() -> String {
    window().and_then(|window| window.location().hash().ok()).unwrap_or_default()
}

/// Replaces the part of the address after the `#` without a new entry in the history; returns the whole address.
pub(crate) fn set_fragment(fragment: &str) -> Result<String, Report> {
    let failed = || Report::AddressStays;
    let window = window().ok_or_else(failed)?;
    let history = window.history().map_err(|_| failed())?;
    history.replace_state_with_url(&JsValue::NULL, "", Some(&format!("#{fragment}"))).map_err(|_| failed())?;
    window.location().href().map_err(|_| failed())
}

/// The text that the browser stores for this page under a name; none if it stores nothing, as in a private window.
pub(crate) fn stored(name: &str) -> Option<String> {
    window()?.local_storage().ok()??.get_item(name).ok()?
}

/// Stores a text for this page under a name. If the browser does not support this, the text is lost with the page.
pub(crate) fn store(name: &str, text: &str) {
    if let Some(Ok(Some(storage))) = window().map(|window| window.local_storage()) {
        let _ = storage.set_item(name, text);
    }
}

/// Downloads a file to the user's machine.
pub(crate) fn download(name: &str, bytes: &[u8]) -> Result<(), Report> {
    let failed = |_: JsValue| Report::NoDownload(name.into());
    let parts = Array::of1(&Uint8Array::from(bytes));
    let blob = web_sys::Blob::new_with_u8_array_sequence(&parts).map_err(failed)?;
    let address = web_sys::Url::create_object_url_with_blob(&blob).map_err(failed)?;
    let page = window().and_then(|window| window.document()).ok_or_else(|| failed(JsValue::NULL))?;
    let anchor: web_sys::HtmlAnchorElement = page.create_element("a").map_err(failed)?.unchecked_into();
    anchor.set_href(&address);
    anchor.set_download(name);
    anchor.click();
    // The download has only begun, and its data must exist until it has ended.
    let forget = Closure::once_into_js(move || {
        let _ = web_sys::Url::revoke_object_url(&address);
    });
    if let Some(window) = window() {
        let _ = window.set_timeout_with_callback_and_timeout_and_arguments_0(forget.unchecked_ref(), 60_000);
    }
    Ok(())
}

/// Reads a file of the browser that is no larger than a limit.
pub(crate) async fn read(file: &web_sys::File, most: u64) -> Chosen {
    let name = file.name();
    if file.size() > most as f64 {
        return Err(Report::TooLarge(name, file.size() as u64, most));
    }
    let buffer = JsFuture::from(file.unchecked_ref::<web_sys::Blob>().array_buffer()).await;
    let buffer = buffer.map_err(|_| Report::Unreadable(name.clone()))?;
    Ok((name, Uint8Array::new(&buffer).to_vec()))
}

/// Lets the user choose a file. The choice is needed because phones do not allow files to be dropped on a page.
pub(crate) fn choose(endings: &str, most: u64) -> Receiver<Chosen> {
    let (sender, receiver) = channel();
    let page = window().and_then(|window| window.document());
    let Some(input) = page.and_then(|page| page.create_element("input").ok()) else { return receiver };
    let input: web_sys::HtmlInputElement = input.unchecked_into();
    input.set_type("file");
    input.set_accept(endings);
    let chosen = input.clone();
    let take = Closure::once_into_js(move || {
        let Some(file) = chosen.files().and_then(|files| files.get(0)) else { return };
        wasm_bindgen_futures::spawn_local(async move {
            let _ = sender.send(read(&file, most).await);
        });
    });
    input.set_onchange(Some(take.unchecked_ref()));
    input.click();
    receiver
}
