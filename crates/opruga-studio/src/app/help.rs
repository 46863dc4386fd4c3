//! The help window, which lists the keys and the actions of the pointer.

use super::Studio;
use egui::{Align2, Frame, Margin, RichText, Ui};

impl Studio {
    /// Shows what the keys and the pointer do.
    pub(super) fn help(&mut self, ui: &Ui) {
        let words = self.language;
        let mut open = self.help_open;
        // In a low window, the help can be scrolled.
        let tall = (ui.ctx().content_rect().height() - 90.0).max(60.0);
        egui::Window::new(words.help())
            .open(&mut open)
            .resizable(false)
            .default_height(tall)
            .collapsible(false)
            .anchor(Align2::CENTER_CENTER, egui::Vec2::ZERO)
            .show(ui.ctx(), |ui| {
                let max_width = (ui.ctx().content_rect().width() - 60.0).clamp(120.0, 560.0);
                ui.set_max_width(max_width);
                egui::ScrollArea::vertical().max_height(tall).show(ui, |ui| {
                    // The margin leaves space for the scroll bar next to the text.
                    Frame::new().inner_margin(Margin { right: 12, ..Margin::ZERO }).show(ui, |ui| {
                        egui::Grid::new("shortcuts").num_columns(2).spacing([18.0, 7.0]).show(ui, |ui| {
                            for (keys, what) in words.shortcuts().lines().filter_map(|line| line.split_once('\t')) {
                                for (text, share) in [(RichText::new(keys).strong(), 0.34), (RichText::new(what), 0.54)]
                                {
                                    ui.scope(|ui| {
                                        ui.set_max_width(share * max_width);
                                        ui.add(egui::Label::new(text.size(13.5)).wrap());
                                    });
                                }
                                ui.end_row();
                            }
                        });
                    });
                });
            });
        self.help_open = open;
    }
}
