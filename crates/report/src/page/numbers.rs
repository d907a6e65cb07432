//! The numbers of figures: playgrounds, views, plots and pictures, in the order of the page.

use crate::model::results::{FigureFile, Record, Results, ViewFile};
use crate::model::section::Playground;
use crate::page::{layout, story};

/// Something with a number.
pub(crate) enum Item<'a> {
    Play(&'a Playground),
    /// With its place among the views.
    View(usize, &'a ViewFile),
    Picture(&'a FigureFile),
}

impl Item<'_> {
    pub(crate) fn id(&self) -> String {
        match self {
            Self::Play(play) => play.id(),
            Self::View(_, view) => view.id.clone(),
            Self::Picture(figure) => figure.id.clone(),
        }
    }
}

/// Returns true if a picture is shown as the still of a view rather than by itself, as those are
/// that the section lists among its figures.
pub(crate) fn is_paper(record: &Record, figure: &FigureFile) -> bool {
    let listed = record.section.figures.contains(&figure.id);
    let is_still = record.views.iter().any(|view| view.fallback == figure.id);
    figure.svg.is_none() && !listed && is_still
}

/// The experiments in the order of the article, each with the number of its first figure.
pub(crate) fn first_numbers(results: &Results) -> Vec<(&Record, usize)> {
    let mut next = 1;
    let numbered = story::in_order(results).into_iter().map(|record| {
        let first = next;
        next += parts(record).0.len();
        (record, first)
    });
    numbered.collect()
}

/// The place of a picture or a playground among the numbered parts of its section; for the still of
/// a view, the place of the view.
pub(crate) fn place(record: &Record, id: &str) -> Option<usize> {
    let (items, _) = parts(record);
    let own = items.iter().position(|item| !matches!(item, Item::View(..)) && item.id() == id);
    let is_still = |item: &Item<'_>| matches!(item, Item::View(_, view) if view.fallback == id);
    own.or_else(|| items.iter().position(is_still))
}

/// The pictures of a text that has no views, in order: those that are not folded, and the stills of
/// such views.
pub(crate) fn pictures(record: &Record) -> Vec<&FigureFile> {
    let (items, seen) = parts(record);
    let mut shown: Vec<&FigureFile> = vec![];
    for item in &items[..seen] {
        let is_still =
            |f: &&FigureFile, view: &ViewFile| f.id == view.fallback && is_paper(record, f);
        let found = match *item {
            Item::Picture(figure) => Some(figure),
            Item::View(_, view) => record.figures.iter().find(|figure| is_still(figure, view)),
            Item::Play(_) => None,
        };
        let is_new = |figure: &&FigureFile| shown.iter().all(|other| other.id != figure.id);
        if let Some(figure) = found.filter(is_new) {
            shown.push(figure);
        }
    }
    shown
}

/// The numbered parts of a section in order, and the number of those that are not folded.
pub(crate) fn parts(record: &Record) -> (Vec<Item<'_>>, usize) {
    let mut all: Vec<Item<'_>> = record.section.playground.iter().map(Item::Play).collect();
    all.extend(record.views.iter().enumerate().map(|(k, view)| Item::View(k, view)));
    let pictures = |plots: bool| {
        let own = record.figures.iter().filter(|f| !is_paper(record, f));
        own.filter(move |f| f.svg.is_some() == plots).map(Item::Picture)
    };
    all.extend(pictures(true).chain(pictures(false)));
    let (mut items, folded): (Vec<Item<'_>>, Vec<Item<'_>>) =
        all.into_iter().partition(|item| layout::shows_figure(record, &item.id()));
    let seen = items.len();
    items.extend(folded);
    (items, seen)
}
